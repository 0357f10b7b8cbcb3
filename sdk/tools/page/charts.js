'use strict';
// Charts over time that share one window and one cursor.
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const kColours = ['#0b7fd6', '#e0662b', '#2e9e5b', '#9b59d0', '#c2459a', '#8a7a1f'];

/** A canvas in device pixels; draws in CSS pixels. */
function prepare(canvas) {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
  }
  const g = canvas.getContext('2d');
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, w, h);
  g.font = '12px system-ui, sans-serif';
  return {g, w, h};
}

/** Draws the parts that do not depend on the cursor once per key, and copies them afterwards. */
function layered(canvas, key, draw) {
  const {g, w, h} = prepare(canvas), whole = [key, canvas.width, canvas.height, css('--back')].join();
  if (canvas.layerKey !== whole) {
    canvas.layerKey = whole;
    canvas.layer = canvas.layer || document.createElement('canvas');
    canvas.layer.width = canvas.width;
    canvas.layer.height = canvas.height;
    const under = canvas.layer.getContext('2d');
    under.setTransform(g.getTransform());
    under.font = g.font;
    draw(under, w, h);
  }
  g.drawImage(canvas.layer, 0, 0, w, h);
  return {g, w, h};
}

/** Tick spacing: 1, 2 or 5 times a power of ten, for about `count` ticks in `span`. */
function tick(span, count) {
  const raw = span / count, power = Math.pow(10, Math.floor(Math.log10(raw || 1)));
  return power * ([1, 2, 5, 10].find(f => f * power >= raw) || 10);
}
const round = (x, step) => x.toFixed(Math.max(0, Math.min(9, -Math.floor(Math.log10(step) + 1e-9))));
function readable(x) {
  if (x === null || !isFinite(x)) return '-';
  const size = Math.abs(x);
  return size === 0 ? '0' : size >= 100 ? x.toFixed(0) : size >= 10 ? x.toFixed(1) : size >= 1 ? x.toFixed(2) : size >= 1e-3 ? x.toFixed(3) : x.toExponential(1);
}

/** Index of the last entry of t at or before x; -1 before the first. */
function before(t, x) {
  let low = -1, high = t.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= x) low = middle; else high = middle;
  }
  return low;
}

const view = {t0: 0, t1: 1, whole: [0, 1], now: 0, listeners: []};
let pending = false;
function redraw() {
  if (pending) return;
  pending = true;
  requestAnimationFrame(() => {
    pending = false;
    for (const draw of view.listeners) draw();
  });
}
function setNow(t) {
  view.now = Math.max(view.whole[0], Math.min(view.whole[1], t));
  if (view.now < view.t0 || view.now > view.t1) {  // the window follows
    const span = view.t1 - view.t0;
    setWindow(view.now - span / 2, view.now + span / 2);
  }
  redraw();
}
function setWindow(t0, t1) {
  const [a, b] = view.whole, span = Math.min(Math.max(t1 - t0, 0.2), b - a);
  view.t0 = Math.max(a, Math.min(b - span, t0));
  view.t1 = view.t0 + span;
  redraw();
}
function zoom(factor, about) {
  setWindow(about - (about - view.t0) * factor, about + (view.t1 - about) * factor);
}

const kLeft = 56, kRight = 10, kTop = 6, kBottom = 18;
const toX = (t, w) => kLeft + (t - view.t0) / (view.t1 - view.t0) * (w - kLeft - kRight);
const toT = (x, w) => view.t0 + (x - kLeft) / (w - kLeft - kRight) * (view.t1 - view.t0);

function attach(canvas) {
  let drag = null;
  canvas.addEventListener('pointerdown', e => {
    canvas.setPointerCapture(e.pointerId);
    drag = {x: e.offsetX, t0: view.t0, t1: view.t1, moved: false};
  });
  canvas.addEventListener('pointermove', e => {
    if (!drag) return;
    const dt = (e.offsetX - drag.x) / (canvas.clientWidth - kLeft - kRight) * (drag.t1 - drag.t0);
    if (Math.abs(e.offsetX - drag.x) > 3) drag.moved = true;
    if (drag.moved && drag.t1 - drag.t0 < view.whole[1] - view.whole[0] - 1e-6) setWindow(drag.t0 - dt, drag.t1 - dt);
    else if (drag.moved) setNow(toT(e.offsetX, canvas.clientWidth));
  });
  canvas.addEventListener('pointerup', e => {
    if (drag && !drag.moved) setNow(toT(e.offsetX, canvas.clientWidth));
    drag = null;
  });
  canvas.addEventListener('wheel', e => {
    e.preventDefault();
    zoom(Math.exp(e.deltaY * 0.0015), toT(e.offsetX, canvas.clientWidth));
  }, {passive: false});
}

function drawTimeAxis(g, w, h) {
  const step = tick(view.t1 - view.t0, Math.max(2, w / 110));
  g.fillStyle = css('--soft');
  g.strokeStyle = css('--line');
  g.lineWidth = 1;
  for (let t = Math.ceil(view.t0 / step) * step; t <= view.t1; t += step) {
    const x = Math.round(toX(t, w)) + 0.5;
    g.beginPath();
    g.moveTo(x, kTop);
    g.lineTo(x, h - kBottom);
    g.stroke();
    g.textAlign = x > w - 24 ? 'right' : 'center';
    g.fillText(round(t, step) + ' s', x > w - 24 ? w - 4 : x, h - 4);
  }
}
function drawCursor(g, w, h) {
  const x = toX(view.now, w);
  g.strokeStyle = css('--accent');
  g.lineWidth = 1;
  g.beginPath();
  g.moveTo(x, 0);
  g.lineTo(x, h);
  g.stroke();
}

/** Range of values in the window, from lines and the upper ends of bands. */
function rangeOf(series, zero) {
  let low = zero ? 0 : Infinity, high = zero ? 0 : -Infinity;
  for (const s of series) {
    const from = Math.max(0, before(s.t, view.t0)), to = Math.min(s.t.length - 1, before(s.t, view.t1) + 1);
    for (let k = from; k <= to; ++k) {
      const y = s.y[k];
      if (y === null) continue;
      low = Math.min(low, s.band ? y - s.band[k] : y);
      high = Math.max(high, s.band ? y + s.band[k] : y);
    }
  }
  if (!(high >= low)) return [0, 1];
  const pad = (high - low) * 0.08 || Math.abs(high) * 0.1 || 0.1;
  return [zero && low === 0 ? 0 : low - pad, high + pad];
}

function drawSeries(g, s, X, Y) {
  const from = Math.max(0, before(s.t, view.t0)), to = Math.min(s.t.length - 1, before(s.t, view.t1) + 1);
  if (s.band) {
    g.fillStyle = s.colour + '33';
    for (let k = from; k <= to; ++k) {
      if (s.y[k] === null) continue;
      const x0 = X(s.t[k]), x1 = k < to && s.t[k + 1] - s.t[k] < 3 ? X(s.t[k + 1]) : x0 + 2;
      g.fillRect(x0, Y(s.y[k] + s.band[k]), Math.max(1, x1 - x0), Y(s.y[k] - s.band[k]) - Y(s.y[k] + s.band[k]));
    }
  }
  g.strokeStyle = g.fillStyle = s.colour;
  g.lineWidth = s.thin ? 1 : 1.6;
  g.setLineDash(s.dashed ? [5, 4] : []);
  if (s.points) {
    for (let k = from; k <= to; ++k) if (s.y[k] !== null) g.fillRect(X(s.t[k]) - 1.5, Y(s.y[k]) - 1.5, 3, 3);
  } else {
    g.beginPath();
    let pen = false, column = -1, least = 0, most = 0;
    for (let k = from; k <= to; ++k) {
      if (s.y[k] === null) { pen = false; continue; }
      const x = X(s.t[k]), y = Y(s.y[k]);
      if (pen && Math.floor(x) === column) {  // within one pixel only the extremes are visible
        if (y < least || y > most) { least = Math.min(least, y); most = Math.max(most, y); g.lineTo(x, y); }
        continue;
      }
      column = Math.floor(x);
      least = most = y;
      if (pen) g.lineTo(x, y); else g.moveTo(x, y);
      pen = true;
    }
    g.stroke();
  }
  g.setLineDash([]);
}

function makePanel(title, kind) {
  const figure = document.createElement('figure');
  figure.className = 'chart ' + kind;
  const caption = document.createElement('figcaption'), name = document.createElement('span'), value = document.createElement('span');
  name.textContent = title;
  value.className = 'value';
  caption.append(name, value);
  const canvas = document.createElement('canvas');
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', title + ' over time');
  figure.append(caption, canvas);
  document.getElementById('charts').append(figure);
  attach(canvas);
  return {canvas, value};
}

/** series: {name, t, y, colour, band?, points?, dashed?, hold?}; null in y breaks the line. */
function addChart(title, unit, series, zero) {
  series = series.filter(s => s.t.length > 0);
  if (series.length === 0) return;
  const {canvas, value} = makePanel(title + (unit ? ' (' + unit + ')' : ''), 'line');
  view.listeners.push(() => {
    const {g, w, h} = layered(canvas, [view.t0, view.t1], drawUnder);
    drawCursor(g, w, h);
    value.textContent = series.filter(s => !s.quiet).map(s => {
      const k = before(s.t, view.now);
      const text = k < 0 || s.y[k] === null ? '-' : readable(s.y[k]) + (s.band ? ' ± ' + readable(s.band[k]) : '');
      return (s.name ? s.name + ' ' : '') + text;
    }).join('   ');
  });
  function drawUnder(g, w, h) {
    const [low, high] = rangeOf(series, zero);
    const X = t => toX(t, w), Y = y => h - kBottom - (y - low) / (high - low) * (h - kTop - kBottom);
    drawTimeAxis(g, w, h);
    const step = tick(high - low, 4);
    g.textAlign = 'right';
    for (let y = Math.ceil(low / step) * step; y <= high; y += step) {
      g.fillStyle = css('--soft');
      g.fillText(round(y, step), kLeft - 6, Y(y) + 4);
      g.fillStyle = css('--line');
      g.fillRect(kLeft, Math.round(Y(y)), w - kLeft - kRight, 1);
    }
    g.save();
    g.beginPath();
    g.rect(kLeft, 0, w - kLeft - kRight, h - kBottom + 1);
    g.clip();
    for (const s of series) drawSeries(g, s, X, Y);
    g.restore();
  }
}

/** entries: {t, name, colour}, each valid until the next one. */
function addBand(title, rows) {
  rows = rows.filter(r => r.entries.length > 0);
  if (rows.length === 0) return;
  const {canvas, value} = makePanel(title, 'band');
  canvas.style.height = 22 + 20 * rows.length + 'px';
  const times = rows.map(row => row.entries.map(e => e.t));
  view.listeners.push(() => {
    const {g, w, h} = layered(canvas, [view.t0, view.t1], drawUnder);
    drawCursor(g, w, h);
    value.textContent = rows.map((row, i) => {
      const k = before(times[i], view.now);
      return (row.name ? row.name + ' ' : '') + (k < 0 ? '-' : row.entries[k].name);
    }).join('   ');
  });
  function drawUnder(g, w, h) {
    drawTimeAxis(g, w, h);
    g.save();
    g.beginPath();
    g.rect(kLeft, 0, w - kLeft - kRight, h);
    g.clip();
    rows.forEach((row, i) => {
      const y = 2 + 20 * i;
      row.entries.forEach((entry, k) => {
        const end = k + 1 < row.entries.length ? row.entries[k + 1].t : row.end;
        const x0 = Math.max(kLeft, toX(entry.t, w)), x1 = Math.min(w - kRight, toX(end, w));
        if (x1 <= x0) return;
        g.fillStyle = entry.colour;
        g.fillRect(x0, y, Math.max(1, x1 - x0), 17);
        if (x1 - x0 > g.measureText(entry.name).width + 8) {
          g.fillStyle = '#ffffff';
          g.textAlign = 'left';
          g.fillText(entry.name, x0 + 4, y + 13);
        }
      });
    });
    g.restore();
  }
}
