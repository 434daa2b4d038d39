// A small plot: lines with bands on two logarithmic axes, as SVG. Colours are classes (c0..c7) of the style sheet.
import {element, short} from './formats.js';

// On a phone a smaller drawing, so that its letters stay as large as the page's.
const size = innerWidth < 720 ? {width: 360, height: 250} : {width: 600, height: 340};
const left = 56, right = 16, top = 10, bottom = 44;

function bounds(values) {
    const good = values.filter((v) => v > 0 && Number.isFinite(v));
    if (!good.length) return null;
    let low = Math.log10(Math.min(...good)), high = Math.log10(Math.max(...good));
    if (high - low < 0.3) [low, high] = [low - 0.3, high + 0.3];
    const air = 0.04 * (high - low);
    return [low - air, high + air];
}

// Powers of ten, with 2 and 5 between them where there is room.
function ticksOf([low, high]) {
    const out = [], steps = high - low > 3.2 ? [1] : high - low > 1.6 ? [1, 3] : [1, 2, 5];
    for (let power = Math.floor(low); power <= Math.ceil(high); power++)
        for (const step of steps) {
            const at = power + Math.log10(step);
            if (at >= low && at <= high) out.push({at, value: step * 10 ** power});
        }
    return out;
}

// series: [{name, color, points: [[x, y, low, high]]}]; null when there is nothing positive to draw.
export function logPlot({title, xName, series, format}) {
    const points = series.flatMap((s) => s.points);
    const xs = bounds(points.map((p) => p[0])), ys = bounds(points.flatMap((p) => [p[1], p[2], p[3]]));
    if (!xs || !ys) return null;
    const {width, height} = size;
    const x = (v) => left + ((Math.log10(v) - xs[0]) / (xs[1] - xs[0])) * (width - left - right);
    const y = (v) => height - bottom - ((Math.log10(v) - ys[0]) / (ys[1] - ys[0])) * (height - top - bottom);
    const at = (px, py) => `${px.toFixed(1)},${py.toFixed(1)}`;
    const svg = element('svg:svg', {viewBox: `0 0 ${width} ${height}`, role: 'img', 'aria-label': title, class: 'plot'});
    for (const tick of ticksOf(xs)) {
        const px = x(tick.value);
        svg.append(element('svg:line', {class: 'grid', x1: px, x2: px, y1: top, y2: height - bottom}),
                   element('svg:text', {x: px, y: height - bottom + 18, 'text-anchor': 'middle'}, format(tick.value)));
    }
    for (const tick of ticksOf(ys)) {
        const py = y(tick.value);
        svg.append(element('svg:line', {class: 'grid', x1: left, x2: width - right, y1: py, y2: py}),
                   element('svg:text', {x: left - 8, y: py + 4, 'text-anchor': 'end'}, percent(tick.value)));
    }
    svg.append(element('svg:text', {class: 'axis', x: (left + width - right) / 2, y: height - 6, 'text-anchor': 'middle'}, xName));
    for (const s of series) {
        const good = s.points.filter((p) => p[0] > 0 && p[1] > 0 && Number.isFinite(p[0]) && Number.isFinite(p[1]));
        const banded = good.filter((p) => p[2] > 0 && Number.isFinite(p[2]) && Number.isFinite(p[3]));
        if (banded.length > 1)
            svg.append(element('svg:polygon', {
                class: 'band ' + s.color,
                points: [...banded.map((p) => at(x(p[0]), y(p[3]))), ...banded.reverse().map((p) => at(x(p[0]), y(p[2])))].join(' ')
            }));
        svg.append(element('svg:polyline', {class: 'curve ' + s.color, points: good.map((p) => at(x(p[0]), y(p[1]))).join(' ')}));
        for (const p of good)
            svg.append(element('svg:circle', {class: 'dot ' + s.color, cx: x(p[0]).toFixed(1), cy: y(p[1]).toFixed(1), r: 3.2},
                               element('svg:title', {}, `${s.name}: ${percent(p[1])} at ${format(p[0])}`)));
    }
    return svg;
}

export const percent = (v) => (v === null || Number.isNaN(v) ? '–' : short(100 * v, 2) + ' %');
