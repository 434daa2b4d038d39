// Text: numbers as people read them, and elements. Nothing here knows of the report.

// Elements are made from code alone: text goes into text nodes, never through a parser.
export function element(tag, attributes = {}, ...children) {
    const made =
        tag.startsWith('svg:') ? document.createElementNS('http://www.w3.org/2000/svg', tag.slice(4)) : document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
        if (value === null || value === undefined || value === false) continue;
        if (name.startsWith('on'))
            made.addEventListener(name.slice(2), value);
        else
            made.setAttribute(name, value === true ? '' : String(value));
    }
    made.append(...children.flat().filter((child) => child !== null && child !== undefined));
    return made;
}

export const byId = (id) => document.getElementById(id);

// Significant digits without an exponent where that stays short.
export function digits(value, count = 3) {
    if (value === null || Number.isNaN(value)) return '–';
    if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
    if (value === 0) return '0';
    const size = Math.abs(value);
    let text = size >= 1e-4 && size < 1e6 ? Number(value.toPrecision(count)).toString() : value.toExponential(count - 1);
    if (size >= 1e-4 && size < 1e6) {
        const places = Math.max(0, count - 1 - Math.floor(Math.log10(size)));
        text = Math.abs(Number(value.toPrecision(count))).toFixed(Math.min(places, 12));
        if (value < 0) text = '-' + text;
    }
    return text.replace('-', '−');
}

// The same without zeros at the end, for values whose precision is not the point.
export const short = (value, count = 3) => digits(value, count).replace(/(\.\d*?)0+$/, '$1').replace(/\.$/, '');

// A value to the second digit of its error: ['0.1703', '0.0012'].
export function measured(value, error, count = 4) {
    const places = error > 0 ? Math.max(0, 1 - Math.floor(Math.log10(error))) : 99;
    if (!Number.isFinite(value) || places > 8 || Math.abs(value) >= 1e6) return [digits(value, count), error > 0 ? digits(error, 2) : ''];
    return [value, error].map((v) => v.toFixed(places).replace('-', '−'));
}

// A pixel's value: a NaN is one, not a value that is absent.
export const pixelDigits = (value) => (Number.isNaN(value) ? 'NaN' : digits(value, 5));

export function duration(seconds) {
    if (seconds === null || Number.isNaN(seconds)) return '–';
    if (seconds < 1e-3) return short(seconds * 1e6, 2) + ' µs';
    if (seconds < 1) return short(seconds * 1e3) + ' ms';
    if (seconds < 120) return short(seconds) + ' s';
    if (seconds < 7200) return short(seconds / 60) + ' min';
    if (seconds < 172800) return short(seconds / 3600) + ' h';
    return short(seconds / 86400) + ' days';
}

export const counted = (count, one, many = one + 's') => `${count.toLocaleString('en')} ${count === 1 ? one : many}`;

export const signed = (value, count = 3) => (value > 0 ? '+' : '') + digits(value, count);

export function listed(words) {
    return words.length < 2 ? words.join('') : words.slice(0, -1).join(', ') + ' and ' + words[words.length - 1];
}

// The number that JSON had no word for.
export const fromJson = (value) => (value === null ? NaN : Number(value));
