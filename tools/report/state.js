// What the page shows, and what of it is chosen at the moment. Changes go through set(); who shows something subscribes.
import {fromJson} from './formats.js';
import {decodeMap, decodePicture} from './picture.js';

export const report = JSON.parse(document.getElementById('data').textContent);
export const entries = report.entries;
export const reference = report.reference;
export const unit = 2 ** report.exponent; // what a half of 1 stands for

// The first word is what the badge says.
export const standings = {
    reference: ['reference', 'What the others are measured against.'],
    agrees: ['agrees', 'No difference to the reference beyond noise.'],
    cannotTell: ['noisy', 'Too noisy to tell: longer rendering would decide it.'],
    missesPaths: [
        'different by definition',
        'Its algorithm leaves light paths out: it is meant to look different, and is judged only on what it covers.'
    ],
    biased: ['biased', 'Its brightness is off by a little, but by more than noise can explain.'],
    differs: ['differs / wrong', 'It converges to another picture, and nothing in its algorithm says that it should.'],
    debug: ['debug view', 'It shows no light.'],
    unjudged: ['not judged', 'Whether it differs by noise or by more cannot be told.'],
};

// An entry's sentence without the words that its badge says.
export const found = (e) => e.verdict.replace(/^(agrees|noisy|biased|differs|wrong|not judged|a debug view): /, '')
                                .replace(/^cannot tell yet, /, '')
                                .replace(/^misses by definition: /, 'missing: ');

const sizes = entries.map((e) => e.picture);
const base = sizes.find((p) => p.width) || {fullWidth: 1, fullHeight: 1};
export const fullWidth = base.fullWidth, fullHeight = base.fullHeight;

export const layerNames = [...new Set(entries.flatMap((e) => e.layers.filter((l) => l.width).map((l) => l.name)))];
export const mapNames = [...new Set(entries.flatMap((e) => e.maps.filter((m) => m.width).map((m) => m.name)))];

const startA = 0;
const startB = reference !== null && reference !== startA ? reference : Math.min(1, entries.length - 1);
export const state = {
    layout: 'grid',  // grid, single, wipe
    show: 'picture', // picture, difference, or map:NAME
    layer: '',
    a: startA,
    b: startB,
    exposure: fromJson(report.exposure) || 0,
    scale: 0, // of differences; 0: automatic
    zoom: 1,  // 1: the whole picture
    x: 0.5,
    y: 0.5, // the point in the middle, as parts of the picture
    wipe: 0.5,
    pixel: null, // {x, y} in pixels of the full picture
};
export const startExposure = state.exposure;

const listeners = [];
let waiting = false, changed = new Set();
export const subscribe = (listener) => listeners.push(listener);
export function set(values) {
    for (const [name, value] of Object.entries(values)) {
        if (state[name] === value) continue;
        state[name] = value;
        changed.add(name);
    }
    if (changed.size && !waiting) {
        waiting = true;
        requestAnimationFrame(() => {
            waiting = false;
            const now = changed;
            changed = new Set();
            for (const listener of listeners) listener(now);
        });
    }
}
export const redraw = () => {
    changed.add('data');
    set({});
};

// Pictures and maps that are decoded, being decoded, or broken.
const decoded = new Map(), failures = new Map();
function fetched(block, decode) {
    if (!block || block.block === undefined) return null;
    const known = decoded.get(block.block);
    if (known !== undefined) return known;
    decoded.set(block.block, null);
    decode().then((result) => decoded.set(block.block, result), (error) => failures.set(block.block, String(error))).then(redraw);
    return null;
}
const pictureBlock = (index, layer) => (layer === '' ? entries[index].picture : entries[index].layers.find((l) => l.name === layer));
const mapBlock = (index, name) => entries[index].maps.find((m) => m.name === name);

export const pictureOf = (index, layer = state.layer) => {
    const block = pictureBlock(index, layer);
    return fetched(block, () => decodePicture(block, report.mantissa));
};
export const mapOf = (index, name) => {
    const block = mapBlock(index, name);
    return fetched(block, () => decodeMap(block));
};
export const mapInfo = (name) => {
    for (const e of entries)
        for (const m of e.maps)
            if (m.name === name) return m;
    return null;
};
export const shownMap = () => (state.show.startsWith('map:') ? state.show.slice(4) : null);

// Why there is nothing to draw for an entry, or '' while it is being decoded.
export function absence(index) {
    if (state.show === 'difference' && index === state.b && state.layout !== 'wipe') return 'B: the others are compared with it';
    const map = shownMap(), block = map === null ? pictureBlock(index, state.layer) : mapBlock(index, map);
    if (!block || block.block === undefined) {
        if (map !== null) return index === reference ? 'the reference itself' : `no ${map} map`;
        if (state.layer === '') return 'no picture';
        return block ? 'this layer was left out for size' : 'no such layer';
    }
    return failures.has(block.block) ? 'cannot be decoded: ' + failures.get(block.block) : '';
}

export const mapValue = (info, code) =>
    (code === -128 ? NaN : info.low + ((info.high - info.low) * (code + report.mapSteps)) / (2 * report.mapSteps));

// Where in a pyramid a pixel of the full picture lies, or null. factor: pixels of the full picture a stored one, along each axis.
export function valueAt(pyramid, pixel, factor = report.factor) {
    if (!pyramid || !pixel) return null;
    const x = Math.min(pyramid.width - 1, Math.floor(pixel.x / factor)), y = Math.min(pyramid.height - 1, Math.floor(pixel.y / factor));
    return {index: y * pyramid.width + x, level: pyramid.levels[0]};
}
