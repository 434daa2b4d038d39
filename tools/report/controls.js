// The tool bar, the keys and the help: each command has one place here, with the key that does it and the words that say it.
import {element, byId, digits, signed} from './formats.js';
import {asGradient, divergingScale, sequentialScale} from './color.js';
import {
    state,
    set,
    subscribe,
    entries,
    layerNames,
    mapNames,
    mapInfo,
    shownMap,
    startExposure,
    fullWidth,
    fullHeight,
    report
} from './state.js';
import {differenceScale, fitScale} from './draw.js';
import {zoomTo, panBy, follow} from './input.js';
import {tileInUse} from './views.js';

const clamped = (v, low, high) => Math.min(high, Math.max(low, v));
const expose = (ev) => set({exposure: clamped(Math.round(ev * 100) / 100, startExposure - 16, startExposure + 16)});
const rescale = (factor) => set({scale: differenceScale() * factor});
const flip = () => set({a: state.b, b: state.a});
const shows = ['picture', ...(entries.length > 1 ? ['difference'] : []), ...mapNames.map((n) => 'map:' + n)];
const next = (list, now, step = 1) => list[(list.indexOf(now) + step + list.length) % list.length];
const onePixel = () => {
    const {canvas} = tileInUse();
    zoomTo(tileInUse(), 1 / fitScale(canvas.width, canvas.height, {width: fullWidth, height: fullHeight}));
};
function step(dx, dy) {
    const from = state.pixel || {x: Math.floor(fullWidth / 2), y: Math.floor(fullHeight / 2)}, f = report.factor;
    const pixel = state.pixel ? {x: clamped(from.x + dx * f, 0, fullWidth - 1), y: clamped(from.y + dy * f, 0, fullHeight - 1)} : from;
    set({pixel});
    follow(tileInUse());
}

// [keys as shown, what they do, key test, action]
const keys = [
    ['G  S  W', 'grid, single picture, wipe', /^[gsw]$/, (e) => set({layout: {g: 'grid', s: 'single', w: 'wipe'}[e.key]})],
    ['F', 'flip: swap A and B', /^f$/, flip],
    ['1 … 9', 'that picture becomes A (with Alt: B)', /^[1-9]$/, (e) => Number(e.key) <= entries.length && set(e.altKey ? {b: e.key - 1} : {a: e.key - 1})],
    ['N', 'the next picture becomes A', /^n$/, () => set({a: (state.a + 1) % entries.length})],
    ['P  D  M', 'picture, difference to B, next map', /^[pdm]$/, (e) => {
        if (e.key === 'p') set({show: 'picture'});
        else if (e.key === 'd') entries.length > 1 && set({show: 'difference'});
        else if (mapNames.length) set({show: 'map:' + next(mapNames, shownMap())});
    }],
    ['L', 'next layer', /^l$/, () => set({layer: next(['', ...layerNames], state.layer)})],
    ['E  Shift E', 'exposure up, down by 1/4 EV', /^e$/i, (e) => expose(state.exposure + (e.shiftKey ? -0.25 : 0.25))],
    ['0', 'exposure and difference scale as at the start', /^0$/, () => set({exposure: startExposure, scale: 0})],
    [',  .', 'difference scale smaller, larger', /^[,.]$/, (e) => rescale(e.key === ',' ? 1 / 2 ** 0.5 : 2 ** 0.5)],
    ['[  ]', 'wipe to the left, to the right', /^[[\]]$/, (e) => set({layout: 'wipe', wipe: clamped(state.wipe + (e.key === '[' ? -0.05 : 0.05), 0, 1)})],
    ['+  −', 'zoom in, out', /^[+=−-]$/, (e) => zoomTo(tileInUse(), state.zoom * (/[+=]/.test(e.key) ? Math.SQRT2 : Math.SQRT1_2))],
    ['Z  X', 'whole picture, one pixel for a pixel', /^[zx]$/, (e) => (e.key === 'z' ? zoomTo(tileInUse(), 1) : onePixel())],
    ['H  J  K  I', 'pan left, down, right, up', /^[hjki]$/, (e) => {
        const {width} = tileInUse().canvas, way = {h: [1, 0], j: [0, -1], k: [-1, 0], i: [0, 1]}[e.key];
        panBy(tileInUse(), way[0] * width * 0.1, way[1] * width * 0.1);
    }],
    ['arrows', 'crosshair, with Shift by 10 (pictures must have the focus)', null, null],
    ['T', 'light or dark', /^t$/, () => toggleTheme()],
    ['?', 'this help', /^\?$/, () => toggleHelp()],
];

// The choice is remembered where the browser lets a page do that (of a file some do not), and forgotten when it is the system's again.
const themeKey = 'chiaro-theme', systemTheme = () => (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
function remembered(use) {
    try {
        return use(localStorage);
    } catch { return null; }
}
export function startTheme() {
    const theme = remembered((store) => store.getItem(themeKey));
    if (theme === 'dark' || theme === 'light') document.documentElement.dataset.theme = theme;
    byId('theme-button').addEventListener('click', toggleTheme);
}
function toggleTheme() {
    const root = document.documentElement, theme = (root.dataset.theme || systemTheme()) === 'dark' ? 'light' : 'dark';
    root.dataset.theme = theme;
    remembered((store) => (theme === systemTheme() ? store.removeItem(themeKey) : store.setItem(themeKey, theme)));
}

function toggleHelp() {
    const help = byId('help');
    help.open ? help.close() : help.showModal();
}

const arrows = {
    ArrowLeft: [-1, 0],
    ArrowRight: [1, 0],
    ArrowUp: [0, -1],
    ArrowDown: [0, 1]
};
function pressed(event) {
    const typing = event.target.closest('input, select, textarea, dialog');
    if (event.ctrlKey || event.metaKey || (typing && !(event.target.type === 'range' && /^[a-z?]$/.test(event.key)) && event.key !== '?'))
        return;
    if (arrows[event.key] && event.target.closest('#stage')) {
        const far = event.shiftKey ? 10 : 1;
        step(arrows[event.key][0] * far, arrows[event.key][1] * far);
        event.preventDefault();
        return;
    }
    const key = event.key.length === 1 ? (event.altKey && /^Digit/.test(event.code) ? event.code.slice(5) : event.key) : event.key;
    const found = keys.find(([, , test]) => test && test.test(key === 'E' ? 'e' : key));
    if (!found) return;
    event.preventDefault();
    found[3]({key, shiftKey: event.shiftKey, altKey: event.altKey});
}

// A row of buttons of which one is on.
function choice(id, label, options, current, choose) {
    const group = byId(id);
    group.setAttribute('role', 'group');
    group.setAttribute('aria-label', label);
    group.replaceChildren(
        ...options.map(([value, text, title]) => element('button', {'data-value': value, title, onclick: () => choose(value)}, text)));
    return () => {
        for (const button of group.children) button.setAttribute('aria-pressed', String(button.dataset.value === current()));
    };
}

function pictures(id, name) {
    const select = byId(id);
    select.append(...entries.map((e, i) => element('option', {value: i}, `${i + 1}  ${e.name}`)));
    select.addEventListener('change', () => set({[name]: Number(select.value)}));
    return () => (select.value = state[name]);
}

const updates = [];
function build() {
    updates.push(choice('layouts', 'arrangement',
                        [['grid', 'Grid', 'all pictures (G)'], ['single', 'Single', 'A alone (S)'], ['wipe', 'Wipe', 'A and B in one (W)']],
                        () => state.layout, (layout) => set({layout})));
    const names = {picture: 'Picture', difference: 'Difference'};
    updates.push(choice('shows', 'what is shown',
                        shows.map((s) => [s, names[s] || s.slice(4),
                                          s === 'difference' ? 'luminance of each minus that of B (D)'
                                          : s === 'picture'  ? 'the picture (P)'
                                                             : mapInfo(s.slice(4)).caption + ' (M)']),
                        () => state.show, (show) => set({show})));
    updates.push(pictures('pick-a', 'a'), pictures('pick-b', 'b'));
    byId('flip').addEventListener('click', flip);
    const layers = byId('layer');
    layers.append(element('option', {value: ''}, 'whole picture'), ...layerNames.map((name) => element('option', {value: name}, name)));
    layers.addEventListener('change', () => set({layer: layers.value}));
    byId('layer-field').hidden = layerNames.length === 0;
    updates.push(() => (layers.value = state.layer));
    const exposure = byId('exposure');
    exposure.min = startExposure - 10;
    exposure.max = startExposure + 10;
    exposure.addEventListener('input', () => expose(Number(exposure.value)));
    byId('exposure-reset').addEventListener('click', () => set({exposure: startExposure}));
    updates.push(() => {
        exposure.value = state.exposure;
        byId('exposure-value').textContent = (state.exposure < 0 ? '−' : '+') + Math.abs(state.exposure).toFixed(2) + ' EV';
        byId('exposure-reset').disabled = state.exposure === startExposure;
    });
    const scale = byId('scale');
    scale.addEventListener('input', () => set({scale: 2 ** Number(scale.value)}));
    byId('scale-reset').addEventListener('click', () => set({scale: 0}));
    const wipe = byId('wipe');
    wipe.addEventListener('input', () => set({wipe: Number(wipe.value)}));
    updates.push(() => {
        byId('scale-field').hidden = state.show !== 'difference';
        byId('exposure-field').hidden = state.show !== 'picture';
        byId('wipe-field').hidden = state.layout !== 'wipe';
        byId('scale-reset').disabled = state.scale === 0;
        scale.value = Math.log2(differenceScale());
        byId('scale-value').textContent = '± ' + digits(differenceScale(), 2);
        wipe.value = state.wipe;
    });
    byId('zoom-in').addEventListener('click', () => zoomTo(tileInUse(), state.zoom * 2));
    byId('zoom-out').addEventListener('click', () => zoomTo(tileInUse(), state.zoom / 2));
    byId('zoom-fit').addEventListener('click', () => zoomTo(tileInUse(), 1));
    byId('zoom-one').addEventListener('click', onePixel);
    for (const axis of ['x', 'y']) {
        const field = byId('pixel-' + axis);
        field.max = (axis === 'x' ? fullWidth : fullHeight) - 1;
        field.addEventListener('change', () => {
            const pixel = {x: 0, y: 0, ...state.pixel};
            pixel[axis] = clamped(Math.round(Number(field.value)) || 0, 0, Number(field.max));
            set({pixel});
            follow(tileInUse());
        });
    }
}

// The colours of what is shown, with their numbers.
function legend() {
    const bar = byId('scale-bar'), map = shownMap(), info = map && mapInfo(map), difference = state.show === 'difference';
    bar.hidden = !difference && !info;
    if (bar.hidden) return;
    const diverging = difference || info.diverging, low = difference ? -differenceScale() : info.low,
          high = difference ? differenceScale() : info.high;
    byId('scale-colors').style.background = asGradient(diverging ? divergingScale : sequentialScale);
    byId('scale-low').textContent = signed(low, 3);
    byId('scale-middle').textContent = digits((low + high) / 2, 3);
    byId('scale-high').textContent = signed(high, 3);
    byId('scale-text').textContent =
        difference ? (state.layout === 'grid'
                          ? `luminance minus that of ${entries[state.b].name}: blue is darker, red is brighter`
                          : `luminance of ${entries[state.a].name} minus that of ${entries[state.b].name}: blue is darker, red is brighter`)
                   : info.caption;
}

export function startControls() {
    build();
    byId('help-keys')
        .append(...keys.flatMap(
            ([shown, text]) => [element('dt', {}, ...shown.split('  ').map((k) => element('kbd', {}, k))), element('dd', {}, text)]));
    byId('help-button').addEventListener('click', toggleHelp);
    byId('help-close').addEventListener('click', toggleHelp);
    document.addEventListener('keydown', pressed);
    const refresh = () => {
        for (const update of updates) update();
        byId('zoom-value').textContent = zoomText();
        legend();
    };
    subscribe((changed) => (changed.size === 1 && changed.has('pixel') ? null : refresh()));
    refresh();
}

function zoomText() {
    const {canvas} = tileInUse(), scale = state.zoom * fitScale(canvas.width, canvas.height, {width: fullWidth, height: fullHeight});
    return digits(100 * scale, 3) + ' %';
}
