// The stage: one tile an entry in the grid, one tile alone, or two in one with a wipe. The crosshair lies over each.
import {halfValues, luminance} from './color.js';
import {drawEntry, fullSize, placement} from './draw.js';
import {byId, counted, digits, element, pixelDigits} from './formats.js';
import {attachPointers} from './input.js';
import {
    absence,
    entries,
    found,
    fullHeight,
    fullWidth,
    mapInfo,
    mapOf,
    mapValue,
    pictureOf,
    report,
    set,
    shownMap,
    standings,
    state,
    subscribe,
    unit,
    valueAt
} from './state.js';

const tiles = new Map();
export const stage = byId('stage');

export const badge = (standing) => element('span', {class: 'badge ' + standing, title: standings[standing][1]}, standings[standing][0]);

function makeTile(index) {
    const canvas = element('canvas', {role: 'img'});
    const message = element('p', {class: 'message'}), note = element('p', {class: 'odd'});
    const wipeLine = element('div', {class: 'wipe-line'}, element('span', {class: 'wipe-knob'})),
          wipeNames = element('div', {class: 'wipe-names'}, element('span'), element('span'));
    const across = element('div', {class: 'hair across'}), down = element('div', {class: 'hair down'}),
          box = element('div', {class: 'hair box'});
    const frame = element('div', {class: 'frame'}, canvas, message, across, down, box, wipeLine, wipeNames, note);
    const title = element('figcaption');
    const tile = {
        index,
        canvas,
        frame,
        message,
        note,
        title,
        across,
        down,
        box,
        wipeLine,
        wipeNames,
        root: element('figure', {class: 'tile'}, frame, title)
    };
    attachPointers(tile);
    return tile;
}

function shownEntries() {
    if (state.layout !== 'grid') return [state.a];
    return entries.map((_, i) => i);
}

// The number is the key that picks the entry.
function caption(index) {
    const e = entries[index], letter = index === state.a ? 'A' : index === state.b ? 'B' : '';
    return [
        element('span', {class: 'line'},
                element('button', {class: 'name', title: `show ${e.name} alone`, onclick: () => set({a: index, layout: 'single'})}, e.name),
                letter
                    ? element('abbr', {class: 'letter', title: letter === 'A' ? 'the first of two (A)' : 'the second of two (B)'}, letter)
                    : null,
                e.name === standings[e.standing][0] ? null : badge(e.standing)),
        element('span', {class: 'covers', title: e.covers ? 'the light paths that it makes; the last section says how to read them' : null},
                e.covers || found(e))
    ];
}

function layOut() {
    const shown = shownEntries();
    stage.className = state.layout;
    const count = shown.length, columns = count < 4 ? count : count === 4 ? 2 : 3;
    stage.style.setProperty('--columns', columns);
    stage.style.setProperty('--aspect', fullWidth / fullHeight);
    stage.replaceChildren(...shown.map((index) => {
        if (!tiles.has(index)) tiles.set(index, makeTile(index));
        const tile = tiles.get(index);
        tile.title.replaceChildren(...caption(index));
        return tile.root;
    }));
    resize();
}

function resize() {
    const ratio = window.devicePixelRatio || 1;
    for (const index of shownEntries()) {
        const {canvas, frame} = tiles.get(index), box = frame.getBoundingClientRect();
        const width = Math.max(1, Math.round(box.width * ratio)), height = Math.max(1, Math.round(box.height * ratio));
        if (canvas.width !== width) canvas.width = width;
        if (canvas.height !== height) canvas.height = height;
    }
}

function drawTile(tile, index) {
    const context = tile.canvas.getContext('2d'), {width, height} = tile.canvas, wiped = state.layout === 'wipe';
    context.clearRect(0, 0, width, height);
    let drawn = drawEntry(context, index, state.b);
    if (wiped) {
        context.save();
        context.beginPath();
        context.rect(state.wipe * width, 0, width, height);
        context.clip();
        context.clearRect(0, 0, width, height);
        drawn = drawEntry(context, state.b, state.a) && drawn;
        context.restore();
        tile.wipeLine.style.left = `${100 * state.wipe}%`;
        tile.wipeNames.children[0].textContent = 'A  ' + entries[state.a].name;
        tile.wipeNames.children[1].textContent = 'B  ' + entries[state.b].name;
    }
    tile.frame.classList.toggle('wiped', wiped);
    tile.frame.classList.toggle('zoomed', state.zoom > 1);
    const why = absence(index);
    tile.message.textContent =
        drawn
            ? ''
            : why || (state.show === 'difference' && pictureOf(index) && pictureOf(state.b) ? 'sizes differ: no difference' : 'decoding …');
    tile.canvas.setAttribute('aria-label',
                             `${entries[index].name}, ${state.show.replace('map:', '')}${state.layer ? ', ' + state.layer : ''}`);
    const p = entries[index].picture, odd = p.nan + p.infinite;
    tile.note.textContent = odd && state.layer === '' ? `${counted(odd, 'pixel')} not finite` : '';
    drawCross(tile);
}

function drawCross(tile) {
    const {width, height} = tile.canvas, ratio = window.devicePixelRatio || 1;
    const place = placement(width, height, fullSize(tile.index));
    const hidden = state.pixel === null;
    tile.frame.classList.toggle('aimed', !hidden);
    if (hidden) return;
    const f = report.factor, scale = place.scale / ratio, size = Math.max(scale * f, 7);
    const x = (Math.floor(state.pixel.x / f) * f + f / 2 - place.left) * scale,
          y = (Math.floor(state.pixel.y / f) * f + f / 2 - place.top) * scale;
    tile.across.style.transform = `translateY(${y}px)`;
    tile.down.style.transform = `translateX(${x}px)`;
    tile.box.style.transform = `translate(${x - size / 2}px,${y - size / 2}px)`;
    tile.box.style.width = tile.box.style.height = `${size}px`;
}

function readings(index) {
    const picture = pictureOf(index), at = valueAt(picture, state.pixel);
    if (!at) return null;
    const rgb = [0, 1, 2].map((c) => halfValues[at.level.halves[3 * at.index + c]] * unit);
    return {rgb, y: luminance(...rgb)};
}

// The numbers at the crosshair in all pictures; a cell holds the exact value too.
function readOut() {
    const {pixel} = state, body = byId('values'), map = shownMap(), info = map && mapInfo(map);
    byId('map-head').textContent = map || (state.show === 'difference' ? 'Y − Y of B' : '');
    const base = readings(state.b);
    body.replaceChildren(...entries.map((e, index) => {
        const found = readings(index), cell = (value, name) => element('td', {
                                           'data-value': value === null ? null : value,
                                           'data-channel': name,
                                           class: value !== null && !Number.isFinite(value) ? 'strange' : null
                                       },
                                                                       value === null ? '–' : pixelDigits(value));
        let extra = element('td');
        if (map) {
            const at = valueAt(mapOf(index, map), pixel, report.mapFactor);
            if (at) extra = cell(mapValue(mapInfo(map), at.level.codes[at.index]), 'map');
        } else if (state.show === 'difference' && found && base)
            extra = cell(found.y - base.y, 'map');
        const letter = index === state.a ? 'A' : index === state.b ? 'B' : '';
        return element('tr', {},
                       element('th', {scope: 'row'}, element('span', {class: 'swatch c' + (index % 8)}), e.name,
                               letter ? element('abbr', {class: 'letter'}, letter) : null),
                       ...['r', 'g', 'b'].map((name, c) => cell(found ? found.rgb[c] : null, name)), cell(found ? found.y : null, 'y'),
                       extra);
    }));
    byId('pixel-x').value = pixel ? pixel.x : '';
    byId('pixel-y').value = pixel ? pixel.y : '';
    byId('pixel-note').textContent =
        !pixel ? 'point at a picture or tap it to read its values'
               : [map ? report.mapFactor : report.factor].map((f) => (f > 1 ? `${map || 'value'}: mean of ${f} × ${f} pixels` : ''))[0];
    announce();
}

// For those who listen: said once the crosshair rests.
let speaking = 0;
function announce() {
    clearTimeout(speaking);
    if (!state.pixel) return;
    speaking = setTimeout(() => {
        const said = entries.map((e, index) => {
            const found = readings(index);
            return found ? `${e.name}: ${found.rgb.map((v) => (Number.isNaN(v) ? 'not a number' : digits(v, 3))).join(', ')}` : '';
        });
        byId('spoken').textContent = `pixel ${state.pixel.x}, ${state.pixel.y}. ` + said.filter(Boolean).join('; ');
    }, 500);
}

export function startViews() {
    layOut();
    subscribe((changed) => {
        const has = (...names) => names.some((name) => changed.has(name));
        if (has('layout', 'a', 'b')) layOut();
        const onlyPixel = changed.size === 1 && changed.has('pixel');
        for (const index of shownEntries()) onlyPixel ? drawCross(tiles.get(index)) : drawTile(tiles.get(index), index);
        if (has('pixel', 'show', 'layer', 'a', 'b', 'data')) readOut();
    });
    new ResizeObserver(() => {
        resize();
        for (const index of shownEntries()) drawTile(tiles.get(index), index);
    }).observe(stage);
    for (const index of shownEntries()) drawTile(tiles.get(index), index);
    readOut();
}

// The tile that commands without a pointer mean.
export const tileInUse = () => tiles.get(shownEntries().includes(state.a) ? state.a : shownEntries()[0]);
