// Pictures out of the page's text: what pack.cpp did, undone. A picture is decoded when it is first shown.
import {halfValues, nearestHalf} from './color.js';

const letterValues = (() => {
    const values = new Uint8Array(128);
    let next = 0;
    for (let code = 33; code <= 126; code++)
        if (!'<&\\'.includes(String.fromCharCode(code))) values[code] = next++;
    return values;
})();

// Two characters of 91 hold 13 bits, low bits first.
export function bytesOf(text, count) {
    const out = new Uint8Array(count);
    let held = 0, bits = 0, at = 0;
    for (let i = 0; i + 1 < text.length; i += 2) {
        held |= (letterValues[text.charCodeAt(i)] + 91 * letterValues[text.charCodeAt(i + 1)]) << bits;
        bits += 13;
        while (bits >= 8 && at < count) {
            out[at++] = held & 255;
            held >>>= 8;
            bits -= 8;
        }
    }
    return out;
}

async function inflated(bytes) {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

async function blockBytes(block) {
    const holder = document.getElementById('block' + block.block);
    return inflated(bytesOf(holder.textContent, block.bytes));
}

// One plane of two's complement numbers from its residuals at `start`.
function planeOf(raw, start, width, height, bits, median) {
    const n = width * height, out = new Int32Array(n), shift = 32 - bits;
    for (let y = 0, i = 0; y < height; y++)
        for (let x = 0; x < width; x++, i++) {
            let guess = 0;
            if (y === 0)
                guess = x > 0 ? out[i - 1] : 0;
            else {
                const above = out[i - width], left = x > 0 ? out[i - 1] : above;
                const aboveLeft = x > 0 ? out[i - width - 1] : above, aboveRight = x + 1 < width ? out[i - width + 1] : above;
                if (!median)
                    guess = (left + above + aboveLeft + aboveRight + 2) >> 2;
                else if (aboveLeft >= Math.max(left, above))
                    guess = Math.min(left, above);
                else if (aboveLeft <= Math.min(left, above))
                    guess = Math.max(left, above);
                else
                    guess = left + above - aboveLeft;
            }
            const code = bits > 8 ? raw[start + i] | (raw[start + n + i] << 8) : raw[start + i];
            const residual = code & 1 ? -((code + 1) >> 1) : code >> 1;
            out[i] = ((guess + residual) << shift) >> shift;
        }
    return out;
}

// Means of 2 x 2 of what is there. In a picture one pixel that is not finite stays visible.
function halvedPicture(from) {
    const width = (from.width + 1) >> 1, height = (from.height + 1) >> 1, halves = new Uint16Array(3 * width * height);
    for (let y = 0, o = 0; y < height; y++) {
        const up = 2 * y * from.width, down = Math.min(2 * y + 1, from.height - 1) * from.width;
        for (let x = 0; x < width; x++) {
            const left = 2 * x, right = Math.min(2 * x + 1, from.width - 1);
            const a = 3 * (up + left), b = 3 * (up + right), c = 3 * (down + left), d = 3 * (down + right), h = from.halves;
            for (let k = 0; k < 3; k++, o++) {
                const mean = 0.25 * (halfValues[h[a + k]] + halfValues[h[b + k]] + halfValues[h[c + k]] + halfValues[h[d + k]]);
                halves[o] = Number.isFinite(mean) ? nearestHalf(mean) : 0x7e00;
            }
        }
    }
    return {width, height, halves};
}

function halvedMap(from) {
    const width = (from.width + 1) >> 1, height = (from.height + 1) >> 1, codes = new Int8Array(width * height);
    for (let y = 0, o = 0; y < height; y++)
        for (let x = 0; x < width; x++, o++) {
            let sum = 0, count = 0;
            for (let v = 2 * y; v < Math.min(2 * y + 2, from.height); v++)
                for (let u = 2 * x; u < Math.min(2 * x + 2, from.width); u++) {
                    const code = from.codes[v * from.width + u];
                    if (code === -128) continue;
                    sum += code;
                    count++;
                }
            codes[o] = count ? Math.round(sum / count) : -128;
        }
    return {width, height, codes};
}

// Level 0 is what is stored; each further level is half as wide and high.
class Pyramid {
    constructor(base, halve) {
        this.levels = [base];
        this.halve = halve;
    }
    level(wanted) {
        while (this.levels.length <= wanted) {
            const last = this.levels[this.levels.length - 1];
            if (last.width <= 1 && last.height <= 1) return last;
            this.levels.push(this.halve(last));
        }
        return this.levels[wanted];
    }
    get width() { return this.levels[0].width; }
    get height() { return this.levels[0].height; }
}

export async function decodePicture(block, mantissa) {
    const raw = await blockBytes(block), {width, height} = block, n = width * height, bits = 6 + mantissa;
    const planes = [0, 1, 2].map((c) => planeOf(raw, 2 * n * c, width, height, bits, block.predictor === 1));
    const halves = new Uint16Array(3 * n), mask = (1 << bits) - 1, shift = 10 - mantissa;
    for (let i = 0, o = 0; i < n; i++, o += 3) {
        const green = planes[0][i];
        halves[o] = ((green + planes[1][i]) & mask) << shift;
        halves[o + 1] = (green & mask) << shift;
        halves[o + 2] = ((green + planes[2][i]) & mask) << shift;
    }
    return new Pyramid({width, height, halves}, halvedPicture);
}

export async function decodeMap(block) {
    const raw = await blockBytes(block), {width, height} = block;
    return new Pyramid({width, height, codes: Int8Array.from(planeOf(raw, 0, width, height, 8, block.predictor === 1))}, halvedMap);
}
