// From decoded pictures to canvases: only the part that is seen, from the level of detail that the screen can show.
import {asPixels, divergingScale, exposureTable, halfValues, luminance, niceAbove, oddPixel, scaleSteps, sequentialScale} from './color.js';
import {mapInfo, mapOf, pictureOf, report, shownMap, state, unit} from './state.js';

const divergingPixels = asPixels(divergingScale), sequentialPixels = asPixels(sequentialScale);
const table = new Uint16Array(65536);
let tableScale = NaN;
const scratch = document.createElement('canvas');

function currentTable() {
    const scale = unit * 2 ** state.exposure;
    if (scale !== tableScale) exposureTable(scale, table);
    tableScale = scale;
    return table;
}

// Fills out with the pixels x0..x1, y0..y1 of one level.
function paintPicture(out, {width, halves}, {x0, y0, x1, y1}) {
    const bytes = currentTable();
    for (let y = y0, o = 0; y < y1; y++)
        for (let i = 3 * (y * width + x0), end = 3 * (y * width + x1); i < end; i += 3, o++) {
            const r = bytes[halves[i]], g = bytes[halves[i + 1]], b = bytes[halves[i + 2]];
            out[o] = (r | g | b) & 256 ? oddPixel : 0xff000000 | (b << 16) | (g << 8) | r;
        }
}

const levelLuminance = (h, i) => luminance(halfValues[h[i]], halfValues[h[i + 1]], halfValues[h[i + 2]]);

function paintDifference(out, one, other, {x0, y0, x1, y1}) {
    const middle = (scaleSteps - 1) / 2, gain = (middle * unit) / differenceScale();
    for (let y = y0, o = 0; y < y1; y++)
        for (let x = x0; x < x1; x++, o++) {
            const i = 3 * (y * one.width + x), d = levelLuminance(one.halves, i) - levelLuminance(other.halves, i);
            out[o] = Number.isFinite(d) ? divergingPixels[Math.round(middle + Math.max(-middle, Math.min(middle, d * gain)))] : oddPixel;
        }
}

function paintMap(out, {width, codes}, {x0, y0, x1, y1}, diverging) {
    const colors = diverging ? divergingPixels : sequentialPixels, steps = report.mapSteps;
    const lookup = new Uint32Array(256);
    for (let code = -128; code < 128; code++) {
        const t = Math.min(1, Math.max(0, (code + steps) / (2 * steps)));
        lookup[code & 255] = code === -128 ? oddPixel : colors[Math.round(t * (scaleSteps - 1))];
    }
    for (let y = y0, o = 0; y < y1; y++)
        for (let i = y * width + x0, end = y * width + x1; i < end; i++, o++) out[o] = lookup[codes[i] & 255];
}

// The scale that shows 99 % of the differences to the other picture without clipping.
const automatic = new Map();
function automaticScale(a, b) {
    const key = [a, b, state.layer].join('|'), one = pictureOf(a), other = pictureOf(b);
    if (automatic.has(key)) return automatic.get(key);
    if (!one || !other || one.width !== other.width || one.height !== other.height) return 1;
    const sizes = [], h = one.levels[0].halves, g = other.levels[0].halves,
          step = 3 * Math.max(1, Math.floor(one.width * one.height / 20011));
    for (let i = 0; i + 2 < h.length; i += step) {
        const d = Math.abs(levelLuminance(h, i) - levelLuminance(g, i)) * unit;
        if (d > 0 && Number.isFinite(d)) sizes.push(d);
    }
    sizes.sort((p, q) => p - q);
    const scale = sizes.length ? niceAbove(sizes[Math.floor(0.99 * (sizes.length - 1))]) : 1;
    automatic.set(key, scale);
    return scale;
}
// In a grid every picture is compared with B, so the scale is that of the first that differs.
export function differenceScale() {
    if (state.scale > 0) return state.scale;
    return automaticScale(state.a === state.b ? (state.b === 0 ? 1 : 0) % report.entries.length : state.a, state.b);
}

// Device pixels a pixel of the full picture, at which all of it is seen.
export const fitScale = (width, height, full) => Math.min(width / full.width, height / full.height);

// Where things are in a canvas of this size: device pixels = (pixel - left) x scale.
export function placement(width, height, full) {
    const scale = state.zoom * fitScale(width, height, full);
    return {scale, left: state.x * full.width - width / (2 * scale), top: state.y * full.height - height / (2 * scale)};
}

function painter(index, other) {
    const map = shownMap();
    if (map !== null) {
        const pyramid = mapOf(index, map), info = mapInfo(map);
        return pyramid &&
               {pyramid, factor: report.mapFactor, paint: (out, level, part) => paintMap(out, pyramid.level(level), part, info.diverging)};
    }
    const one = pictureOf(index);
    if (!one) return null;
    if (state.show === 'difference' && index === other) return null;
    if (state.show !== 'difference')
        return {pyramid: one, factor: report.factor, paint: (out, level, part) => paintPicture(out, one.level(level), part)};
    const two = pictureOf(other);
    if (!two || two.width !== one.width || two.height !== one.height) return null;
    return {
        pyramid: one,
        factor: report.factor,
        paint: (out, level, part) => paintDifference(out, one.level(level), two.level(level), part)
    };
}

// Draws one entry into a context of a canvas; whether there was something to draw.
export function drawEntry(context, index, other) {
    const {width, height} = context.canvas, full = fullSize(index), place = placement(width, height, full);
    const source = painter(index, other);
    if (!source) return false;
    const stored = place.scale * source.factor; // device pixels a stored pixel
    const wanted = stored >= 1 ? 0 : Math.floor(-Math.log2(stored) + 1e-6), level = source.pyramid.level(wanted);
    const shrink = source.factor * 2 ** source.pyramid.levels.indexOf(level);
    const part = {
        x0: Math.max(0, Math.floor(place.left / shrink)),
        y0: Math.max(0, Math.floor(place.top / shrink)),
        x1: Math.min(level.width, Math.ceil((place.left + width / place.scale) / shrink)),
        y1: Math.min(level.height, Math.ceil((place.top + height / place.scale) / shrink)),
    };
    const w = part.x1 - part.x0, h = part.y1 - part.y0;
    if (w <= 0 || h <= 0) return true;
    scratch.width = w;
    scratch.height = h;
    const image = new ImageData(w, h);
    source.paint(new Uint32Array(image.data.buffer), source.pyramid.levels.indexOf(level), part);
    const brush = scratch.getContext('2d');
    brush.putImageData(image, 0, 0);
    context.imageSmoothingEnabled = stored < 1;
    const size = shrink * place.scale;
    context.drawImage(scratch, 0, 0, w, h, (part.x0 * shrink - place.left) * place.scale, (part.y0 * shrink - place.top) * place.scale,
                      w * size, h * size);
    return true;
}

export const fullSize = (index) => {
    const picture = report.entries[index].picture;
    return {width: Math.max(1, picture.fullWidth), height: Math.max(1, picture.fullHeight)};
};
