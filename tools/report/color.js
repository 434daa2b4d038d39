// Numbers to colours: half floats through tables, exposure and sRGB as the PNG has them, and the scales of maps.

// 65536 halves as floats.
export const halfValues = (() => {
    const out = new Float32Array(65536);
    for (let h = 0; h < 65536; h++) {
        const sign = h & 0x8000 ? -1 : 1, exponent = (h >> 10) & 31, mantissa = h & 1023;
        if (exponent === 0)
            out[h] = sign * mantissa * 2 ** -24;
        else if (exponent === 31)
            out[h] = mantissa ? NaN : sign * Infinity;
        else
            out[h] = sign * (1 + mantissa / 1024) * 2 ** (exponent - 15);
    }
    return out;
})();

// The nearest half of a mean (ties up: means are for looking at).
const floatBits = new Float32Array(1), floatAsInt = new Uint32Array(floatBits.buffer);
export function nearestHalf(value) {
    floatBits[0] = value;
    const bits = floatAsInt[0], sign = (bits >>> 16) & 0x8000, exponent = ((bits >>> 23) & 255) - 112;
    if (exponent >= 31) return sign | (value !== value ? 0x7e00 : value === Infinity || value === -Infinity ? 0x7c00 : 0x7bff);
    if (exponent <= 0) return sign | Math.min(0x400, Math.round(Math.abs(value) * 2 ** 24));
    return sign | Math.min(0x7bff, (((exponent << 23) | (bits & 0x7fffff)) + 0x1000) >>> 13);
}

export const isOdd = (half) => (half & 0x7c00) === 0x7c00; // infinite or not a number
export const oddColor = [57, 255, 20];
const packColor = (r, g, b) => (0xff000000 | (b << 16) | (g << 8) | r) >>> 0; // little endian, as all browsers are
export const oddPixel = packColor(...oddColor);

export const luminance = (r, g, b) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

// Half to byte at an exposure: x 2^EV, then the sRGB curve; 256 marks what is not finite. Positive halves grow with their bits, so the
// table is 256 steps: step b begins where the curve reaches b - 1/2.
const stepStarts = Array.from({length: 256}, (_, b) => {
    const v = (b - 0.5) / 255;
    return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
});
export function exposureTable(scale, table = new Uint16Array(65536)) {
    table.fill(0);
    table.fill(256, 0x7c00, 0x8000);
    table.fill(256, 0xfc00, 0x10000);
    for (let b = 1, from = 0; b < 256; b++) {
        let to = 0x7c00; // the first half of this step lies in from..to
        for (let low = from; low < to;) {
            const middle = (low + to) >> 1;
            if (halfValues[middle] * scale >= stepStarts[b])
                to = middle;
            else
                low = middle + 1;
        }
        table.fill(b - 1, from, to);
        from = to;
        if (b === 255) table.fill(255, to, 0x7c00);
    }
    return table;
}

// Oklab (Ottosson 2020), for scales whose steps look equally large.
const toLinear = (byte) => (byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4);
const toByte = (v) => Math.round(255 * Math.min(1, Math.max(0, v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055)));
function oklab(color) {
    const [r, g, b] = color.map(toLinear);
    const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    return [
        0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s, 1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
        0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s
    ];
}
function fromOklab([L, a, b]) {
    const l = (L + 0.3963377774 * a + 0.2158037573 * b) ** 3, m = (L - 0.1055613458 * a - 0.0638541728 * b) ** 3;
    const s = (L - 0.0894841775 * a - 1.291485548 * b) ** 3;
    return [
        toByte(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s), toByte(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
        toByte(-0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s)
    ];
}

// Colours along a scale of 0 to 1, 511 steps (an odd number: the middle is one of them).
export const scaleSteps = 511;
function scaleOf(stops) {
    const labs = stops.map(oklab), colors = [];
    for (let i = 0; i < scaleSteps; i++) {
        const at = (i / (scaleSteps - 1)) * (labs.length - 1), k = Math.min(Math.floor(at), labs.length - 2), t = at - k;
        colors.push(fromOklab(labs[k].map((v, c) => v + t * (labs[k + 1][c] - v))));
    }
    return colors;
}
// Blue below, grey at zero, red above: the colours of `chiaro diff`. Magma (van der Walt and Smith 2015): the colours of FLIP's authors.
export const divergingScale = scaleOf([[25, 60, 200], [238, 238, 238], [190, 10, 30]]);
export const sequentialScale = scaleOf([
    [0, 0, 4], [28, 16, 68], [79, 18, 123], [129, 37, 129], [181, 54, 122], [229, 80, 100], [251, 135, 97], [254, 194, 135], [252, 253, 191]
]);
export const asPixels = (scale) => Uint32Array.from(scale, (color) => packColor(...color));
export const asGradient = (scale) => {
    const stops = [];
    for (let i = 0; i < scaleSteps; i += 30) stops.push(`rgb(${scale[i].join(',')})`);
    return `linear-gradient(to right,${stops.join(',')})`;
};

// 1, 2 or 5 times a power of ten, no smaller than the value.
export function niceAbove(value) {
    const power = 10 ** Math.floor(Math.log10(value));
    for (const step of [1, 2, 5])
        if (step * power >= value * (1 - 1e-6)) return step * power;
    return 10 * power;
}
