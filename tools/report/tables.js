// Everything beside the pictures: the answer in sentences, verdicts, numbers, curves, settings.
import {byId, counted, digits, duration, element, fromJson, listed, measured, short} from './formats.js';
import {logPlot, percent} from './plot.js';
import {entries, found, mapNames, reference, report, set, standings} from './state.js';
import {badge} from './views.js';

const others = entries.map((e, i) => ({...e, index: i})).filter((e) => e.index !== reference);
const swatch = (index) => element('span', {class: 'swatch c' + (index % 8)});
const strong = (text) => element('strong', {}, text);

// Who leaves light paths out by definition is near or far for that reason: it is ranked only where all do.
const complete = others.filter((e) => !['debug', 'missesPaths'].includes(e.standing));
const ranked = complete.length ? complete : others.filter((e) => e.standing !== 'debug');

// Metrics by name, those that say who is nearest first: value, half interval and whether it is the best, or as good as the best within the
// intervals.
export function ranking() {
    const order = ['relMSE', 'FLIP', 'RMSE', 'relative bias', 'efficiency'];
    const place = (name) => (order.includes(name) ? order.indexOf(name) : order.length);
    const names = [...new Set(others.flatMap((e) => e.metrics.map((m) => m.name)))].sort((p, q) => place(p) - place(q));
    return names.map((name) => {
        const cells = others.map((e) => {
            const m = e.metrics.find((candidate) => candidate.name === name);
            return {index: e.index, metric: m, value: m ? fromJson(m.value) : NaN, error: m ? fromJson(m.error) || 0 : 0};
        });
        const first = cells.find((c) => c.metric);
        const fair = cells.filter((c) => !Number.isNaN(c.value) && ranked.some((e) => e.index === c.index));
        if (first.metric.ranked && fair.length > 1) {
            const cost = (c) => (first.metric.smallerIsBetter ? Math.abs(c.value) : -c.value); // a bias has a sign
            const best = fair.reduce((p, q) => (cost(q) < cost(p) ? q : p));
            for (const c of fair) c.best = c === best ? 'best' : Math.abs(c.value - best.value) <= c.error + best.error ? 'tie' : '';
        }
        return {name, ranked: first.metric.ranked, smaller: first.metric.smallerIsBetter, cells};
    });
}

function agreement() {
    const groups = [
        ['agrees', (n) => [n, n.length === 1 ? ' agrees' : ' agree', ' with the reference']],
        ['cannotTell', (n) => [n, n.length === 1 ? ' is' : ' are', ' too noisy to tell']],
        ['missesPaths', (n) => [n, n.length === 1 ? ' is' : ' are', ' different by definition (algorithms that leave light paths out)']],
        ['biased', (n) => [n, n.length === 1 ? ' is' : ' are', ' biased']],
        ['differs', (n) => [n, n.length === 1 ? ' differs' : ' differ', ': something is wrong']],
        ['debug', (n) => [n, n.length === 1 ? ' is a debug view' : ' are debug views', ' without light']],
        ['unjudged', (n) => [n, n.length === 1 ? ' was' : ' were', ' not judged']]
    ];
    const said = [];
    for (const [standing, words] of groups) {
        const names = others.filter((e) => e.standing === standing).map((e) => e.name);
        if (names.length === 0) continue;
        const [, verb, rest] = words(names);
        if (said.length) said.push('; ');
        said.push(strong(listed(names)), verb + rest);
    }
    return said.length ? [...said, '.'] : ['There is nothing to judge.'];
}

function winner() {
    const columns = ranking().filter((c) => c.ranked), column = columns.find((c) => c.cells.some((x) => x.best === 'best'));
    if (!column) { // one alone: how near it is
        const [only] = ranked, far = ranked.length === 1 && others.length > 1 && complete.length === 1
                                         ? [' is the only one here that makes all light paths']
                                         : [' against the reference'];
        const said = columns.slice(0, 2).map((c) => c.cells.find((x) => x.index === only?.index)).map((x, i) => [columns[i].name, x]);
        const near = said.filter(([, x]) => x && !Number.isNaN(x.value)).map(([name, x]) => {
            const [value, error] = measured(x.value, x.error, 3);
            return `${name} ${value}${error ? ' ± ' + error : ''}`;
        });
        return ranked.length === 1 && near.length
                   ? {label: 'How near', words: [strong(only.name), ...far, `: ${near.join(', ')} (0 is the same).`]}
                   : null;
    }
    const best = column.cells.find((c) => c.best === 'best'), ties = column.cells.filter((c) => c.best === 'tie');
    const times = ranked.filter((e) => e.seconds > 0).map((e) => e.seconds);
    const equal = times.length === ranked.length && Math.max(...times) <= 1.1 * Math.min(...times);
    const when = equal ? `At equal time (${duration(Math.max(...times))})`
                 : times.length ? 'At unequal times (see the table)'
                                : 'Of the pictures as they are';
    const those = ranked.length < others.length ? ' and of those that make all light paths' : '';
    const words = [when + those + ', ', strong(entries[best.index].name), ` is nearest: ${column.name} ${digits(best.value)}`];
    if (ties.length) words.push(`, not to be told apart from ${listed(ties.map((t) => entries[t.index].name))}`);
    const next = column.cells.filter((c) => c.best === '' && Number.isFinite(c.value))
                     .sort((p, q) => Math.abs(p.value - best.value) - Math.abs(q.value - best.value))[0];
    if (next && best.value > 0 && column.smaller)
        words.push(`; next is ${entries[next.index].name} with ${digits(next.value / best.value, 2)} times as much`);
    return {label: 'Better', words: [...words, '.']};
}

function answer() {
    const what = [
        `${counted(entries.length, 'picture')} of the same view`,
        reference !== null ? [', measured against ', strong(entries[reference].name)] : [', no reference'], '.'
    ].flat();
    const show = mapNames.includes('z-score') ? 'z-score' : mapNames[0];
    const where = others.length && entries.length > 1 ? element('button', {
        class: 'link',
        id: 'show-where',
        onclick: () => {
            set({show: show ? 'map:' + show : 'difference', layout: 'grid'});
            byId('viewer').scrollIntoView({behavior: matchMedia('(prefers-reduced-motion: reduce)').matches ? 'auto' : 'smooth'});
        }
    },
                                                                `Show ${show ? 'the ' + show + ' maps' : 'the differences'}`)
                                                      : null;
    const row = (label, ...words) => [element('dt', {}, label), element('dd', {}, ...words)];
    const best = winner();
    byId('answer').replaceChildren(...row('What', ...what), ...row('Agree?', ...agreement()),
                                   ...(best ? row(best.label, ...best.words) : []), ...(where ? row('Where', where) : []));
}

// What the badge means, then what was found.
function sentence(e) {
    const meaning = standings[e.standing][1], said = found(e).replaceAll(' %', '\u00a0%');
    return said ? `${meaning} ${said[0].toUpperCase()}${said.slice(1)}${/ [.!? ] $ /.test(said) ? '' : '.'}`: meaning;
}

function verdicts() {
    byId('verdict-rows').replaceChildren(...entries.map((e, index) => {
        const time = e.seconds > 0
                         ? duration(e.seconds) + (e.prepassSeconds + e.prepareSeconds > 0 ? ` (${duration(e.prepassSeconds + e.prepareSeconds)} before the first sample)` : '')
                                                                       : '';
        const facts =
            [time, e.spp > 0 ? short(e.spp, 4) + ' spp' : '', e.seeds > 1 ? counted(e.seeds, 'seed') : '', e.file].filter(Boolean).join(
                ' · ');
        const odd = e.picture.nan + e.picture.infinite;
        const lost = [
            odd ? `${counted(odd, 'pixel')} not finite (${e.picture.nan} NaN, ${e.picture.infinite} infinite)` : '',
            e.dropped && !(odd && e.source !== 'integrator')
                ? counted(e.dropped, e.source === 'integrator' ? 'non-finite sample dropped' : 'non-finite value',
                          e.source === 'integrator' ? 'non-finite samples dropped' : 'non-finite values')
                : ''
        ].filter(Boolean).join('; ');
        return element(
            'li', {},
            element('div', {class: 'who'}, element('span', {}, swatch(index), strong(e.name)),
                    e.name === standings[e.standing][0] ? null : badge(e.standing)),
            element('div', {class: 'says'}, element('p', {}, sentence(e)),
                    element('p', {class: 'quiet'}, e.covers ? 'Light paths: ' + e.covers : 'Light paths: unknown, a picture from a file'),
                    element('p', {class: 'quiet'}, facts), lost ? element('p', {class: 'warning'}, lost) : null));
    }));
}

function metrics() {
    const columns = ranking();
    if (!columns.length) return byId('metrics').remove();
    const bounded = columns.some((c) => c.cells.some((x) => x.error > 0));
    byId('metric-text').textContent = `Against the reference${bounded ? ', with 95 % intervals over the seeds' : ''}.${
        ranked.length < others.length ? ' Who leaves light paths out by definition, or shows no light, is not ranked.' : ''}`;
    const timed = others.some((e) => e.seconds > 0);
    const sense = (c) => (c.ranked ? (c.smaller ? 'smaller is better' : 'larger is better') : 'for information');
    byId('metric-table')
        .append(element('thead', {},
                        element('tr', {}, element('th', {scope: 'col'}, 'Picture'),
                                timed ? [element('th', {scope: 'col'}, 'time'), element('th', {scope: 'col'}, 'samples')] : null, columns.map((c) => element('th', {scope: 'col'}, c.name, element('small', {}, sense(c)))))),
                element('tbody', {},
                        others.map(
                            (e, row) => element('tr', {}, element('th', {scope: 'row'}, swatch(e.index), e.name), timed ? [element('td', {}, e.seconds > 0 ? duration(e.seconds) : '–'), element('td', {}, e.spp > 0 ? short(e.spp, 4) + ' spp' : '–')] : null, columns.map((c) => {
                                const cell = c.cells[row], parts = /^relative /.test(c.name) ? 100 : 1, [value, error] = measured(parts * cell.value, parts * cell.error);
                                return element('td', {class: cell.best || null}, element('span', {class: 'number'}, value),
                                               error ? element('span', {class: 'quiet'}, ' ± ' + error) : null, parts > 1 && !Number.isNaN(cell.value) ? ' %' : null,
                                               cell.best === 'best'  ? element('span', {class: 'mark'}, 'best')
                                               : cell.best === 'tie' ? element('span', {class: 'mark tie'}, 'tied')
                                                                     : null);
                            })))));
}

function curves() {
    if (!report.curves.length) return byId('curves').remove();
    const series = (column) =>
        report.curves.map((c) => ({
                              name: entries[c.entry].name,
                              color: 'c' + (c.entry % 8),
                              points: c.points.map((p) => [fromJson(p[column]), fromJson(p[2]), fromJson(p[3]), fromJson(p[4])])
                          }));
    const plots = [
        logPlot({title: 'Error against time', xName: 'render time', series: series(0), format: duration}),
        logPlot({title: 'Error against samples', xName: 'samples a pixel', series: series(1), format: (v) => short(v, 2)})
    ];
    const titles = ['Relative error (RMS) against time', 'Relative error (RMS) against samples'];
    byId('plots').append(
        ...plots.map((plot, i) => plot && element('figure', {}, element('figcaption', {}, titles[i]), plot)).filter(Boolean));
    byId('legend').append(...report.curves.map(
        (c) => element('li', {}, swatch(c.entry), element('span', {}, entries[c.entry].name),
                       element('span', {class: 'quiet'},
                               c.slope === null ? ' no slope fitted'
                                                : ` slope ${digits(fromJson(c.slope), 3)}${
                                                      c.slopeError ? ' ± ' + digits(fromJson(c.slopeError), 2) : ''}`))));
    byId('curve-table')
        .append(element('thead', {},
                        element('tr', {},
                                ['Picture', 'Time', 'Samples', 'Error', 'Seeds from', 'to'].map((h) => element('th', {scope: 'col'}, h)))),
                element('tbody', {},
                        report.curves.flatMap(
                            (c) => c.points.map((p) => element('tr', {}, element('th', {scope: 'row'}, entries[c.entry].name),
                                                               element('td', {}, duration(fromJson(p[0]))),
                                                               element('td', {}, short(fromJson(p[1]), 4)),
                                                               [2, 3, 4].map((k) => element('td', {}, percent(fromJson(p[k])))))))));
}

function times() {
    if (!report.timeToError.length || !report.curves.length) return byId('times').remove();
    byId('time-table')
        .append(element('thead', {},
                        element('tr', {}, element('th', {scope: 'col'}, 'Error'),
                                report.curves.map((c) => element('th', {scope: 'col'}, swatch(c.entry), entries[c.entry].name)))),
                element('tbody', {}, report.timeToError.map((row) => {
                    const seconds = row.cells.map((c) => fromJson(c.seconds)),
                          fair = row.cells.map((_, i) => ranked.some((e) => e.index === report.curves[i].entry)),
                          least = Math.min(...seconds.filter((s, i) => s >= 0 && fair[i])), best = (i) => fair[i] && seconds[i] === least;
                    return element(
                        'tr', {}, element('th', {scope: 'row'}, percent(fromJson(row.error))),
                        row.cells.map(
                            (c, i) =>
                                element('td', {class: best(i) ? 'best' : null},
                                        Number.isNaN(seconds[i]) ? element('span', {class: 'quiet'}, 'not reached')
                                                                 : element('span', {class: c.extrapolated ? 'quiet number' : 'number'},
                                                                           (c.extrapolated ? '≈ ' : '') + duration(seconds[i])),
                                        best(i) && fair.filter(Boolean).length > 1 ? element('span', {class: 'mark'}, 'fastest') : null)));
                })));
}

function command(label, text) {
    const button = element('button', {
        class: 'copy',
        'aria-label': `copy the command: ${label}`,
        onclick: async () => {
            try {
                await navigator.clipboard.writeText(text);
            } catch {
                const area = element('textarea');
                area.value = text;
                document.body.append(area);
                area.select();
                document.execCommand('copy');
                area.remove();
            }
            button.textContent = 'Copied';
            byId('spoken').textContent = 'copied';
            setTimeout(() => (button.textContent = 'Copy'), 1500);
        }
    },
                           'Copy');
    return element('li', {}, element('span', {class: 'quiet'}, label),
                   element('div', {class: 'command'}, element('code', {tabindex: 0}, text), button));
}

function making() {
    byId('settings-list')
        .append(...report.settings.flatMap(([name, value]) => [element('dt', {}, name), element('dd', {}, value)]),
                ...(report.machine ? [element('dt', {}, 'machine'), element('dd', {}, report.machine)] : []),
                ...(report.version ? [element('dt', {}, 'program'), element('dd', {}, report.version)] : []));
    byId('commands')
        .append(...(report.command ? [command('this page', report.command)] : []),
                ...entries.filter((e) => e.command).map((e) => command(e.name, e.command)));
    if (!report.notes.length) byId('notes').remove();
    byId('note-list')?.append(...report.notes.map((n) => element('li', {}, n)));
    if (report.reductions.length) {
        byId('reduced').hidden = false;
        byId('reduced').textContent = 'Reduced to fit this page: ' + report.reductions.join('; ') + '. The EXR files hold everything.';
    }
}

function reading() {
    byId('standing-list')
        .append(
            ...['agrees', 'cannotTell', 'biased', 'differs', 'missesPaths'].map((s) => element('li', {}, badge(s), ' ', standings[s][1])));
}

export function startTables() {
    document.title = report.title || 'Chiaro: comparison';
    byId('title').textContent = report.title || 'Comparison';
    byId('origin').textContent = [report.version, report.machine].filter(Boolean).join(' · ');
    answer();
    verdicts();
    metrics();
    curves();
    times();
    making();
    reading();
}
