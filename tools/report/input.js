// Pointers on the pictures: hover and tap read out, drag pans, pinch and wheel zoom, the wipe line is dragged. All pictures move together.
import {fitScale, fullSize, placement} from './draw.js';
import {set, state} from './state.js';

const mostZoom = 64; // device pixels a pixel

function middle(x, y, tile, zoom) {
    const full = fullSize(tile.index), {width, height} = tile.canvas, scale = zoom * fitScale(width, height, full);
    const limited = (at, half) => (half >= 0.5 ? 0.5 : Math.min(1 - half, Math.max(half, at)));
    return {x: limited(x, width / (2 * scale * full.width)), y: limited(y, height / (2 * scale * full.height))};
}

// Zooms so that what lies at a point of the tile (device pixels; its middle by default) stays there.
export function zoomTo(tile, zoom, at = {
    x: tile.canvas.width / 2,
    y: tile.canvas.height / 2
}) {
    const full = fullSize(tile.index), {width, height} = tile.canvas, before = placement(width, height, full);
    const most = Math.max(1, mostZoom / fitScale(width, height, full)), next = Math.min(most, Math.max(1, zoom));
    const scale = next * fitScale(width, height, full);
    const px = before.left + at.x / before.scale, py = before.top + at.y / before.scale;
    set({
        zoom: next,
        ...middle((px - (at.x - width / 2) / scale) / full.width, (py - (at.y - height / 2) / scale) / full.height, tile, next)
    });
}

export function panBy(tile, dx, dy) {
    const full = fullSize(tile.index), {scale} = placement(tile.canvas.width, tile.canvas.height, full);
    set(middle(state.x - dx / (scale * full.width), state.y - dy / (scale * full.height), tile, state.zoom));
}

// Brings the crosshair into sight.
export function follow(tile) {
    const full = fullSize(tile.index), {width, height} = tile.canvas, place = placement(width, height, full);
    const x = (state.pixel.x + 0.5 - place.left) * place.scale, y = (state.pixel.y + 0.5 - place.top) * place.scale;
    if (x < 0 || y < 0 || x > width || y > height)
        set(middle((state.pixel.x + 0.5) / full.width, (state.pixel.y + 0.5) / full.height, tile, state.zoom));
}

function pixelAt(tile, at) {
    const full = fullSize(tile.index), place = placement(tile.canvas.width, tile.canvas.height, full);
    const x = Math.floor(place.left + at.x / place.scale), y = Math.floor(place.top + at.y / place.scale);
    return x < 0 || y < 0 || x >= full.width || y >= full.height ? null : {x, y};
}

export function attachPointers(tile) {
    const {frame} = tile, held = new Map();
    let dragsWipe = false, moved = 0;
    const place = (event) => {
        const box = frame.getBoundingClientRect(), ratio = tile.canvas.width / Math.max(1, box.width);
        return {x: (event.clientX - box.left) * ratio, y: (event.clientY - box.top) * ratio, ratio};
    };
    const aim = (at) => {
        const pixel = pixelAt(tile, at);
        if (pixel && (!state.pixel || pixel.x !== state.pixel.x || pixel.y !== state.pixel.y)) set({pixel});
    };
    frame.addEventListener('pointerdown', (event) => {
        const at = place(event);
        held.set(event.pointerId, at);
        moved = 0;
        dragsWipe = state.layout === 'wipe' && Math.abs(at.x - state.wipe * tile.canvas.width) < 22 * at.ratio;
        frame.setPointerCapture(event.pointerId);
    });
    frame.addEventListener('pointermove', (event) => {
        const at = place(event), last = held.get(event.pointerId);
        if (!last) return aim(at);
        moved += Math.abs(at.x - last.x) + Math.abs(at.y - last.y);
        if (dragsWipe)
            set({wipe: Math.min(1, Math.max(0, at.x / tile.canvas.width))});
        else if (held.size === 2) {
            const [other] = [...held].filter(([id]) => id !== event.pointerId).map(([, p]) => p);
            const before = Math.hypot(last.x - other.x, last.y - other.y), after = Math.hypot(at.x - other.x, at.y - other.y);
            if (before > 0) zoomTo(tile, (state.zoom * after) / before, {x: (at.x + other.x) / 2, y: (at.y + other.y) / 2});
            panBy(tile, (at.x - last.x) / 2, (at.y - last.y) / 2);
        } else
            panBy(tile, at.x - last.x, at.y - last.y);
        held.set(event.pointerId, at);
    });
    const release = (event) => {
        if (held.delete(event.pointerId) && event.type === 'pointerup' && moved < 8) aim(place(event));
        dragsWipe = false;
    };
    frame.addEventListener('pointerup', release);
    frame.addEventListener('pointercancel', release);
    frame.addEventListener('dblclick', (event) => zoomTo(tile, state.zoom > 1 ? 1 : 4, place(event)));
    // The wheel belongs to the page until the pictures are clicked; with Ctrl, and from a pinched touchpad, it always zooms.
    frame.addEventListener('wheel', (event) => {
        if (!event.ctrlKey && !document.getElementById('stage').contains(document.activeElement)) return;
        event.preventDefault();
        zoomTo(tile, state.zoom * 2 ** (-event.deltaY * (event.deltaMode ? 0.1 : event.ctrlKey ? 0.01 : 0.003)), place(event));
    }, {passive: false});
}
