// Draws what the data block of the page holds: one scene per garment, colours, the worn slider, the frames.
'use strict';
window.addEventListener('error', (event) => fail(event.message));
window.addEventListener('unhandledrejection', (event) => fail(String(event.reason)));

function fail(message) {
  document.getElementById('error').textContent = message;
  document.body.dataset.error = message;
}

const data = JSON.parse(document.getElementById('data').textContent);
const find = (id) => document.getElementById(id);

function bytes(text) {
  const raw = atob(text);
  const out = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) out[i] = raw.charCodeAt(i);
  return out.buffer;
}
const floats = (text) => new Float32Array(bytes(text));
const numbers = (text) => new Uint32Array(bytes(text));

function columns(xyz) {
  const n = xyz.length / 3;
  const out = [new Float32Array(n), new Float32Array(n), new Float32Array(n)];
  for (let i = 0; i < n; i++) for (let k = 0; k < 3; k++) out[k][i] = xyz[3 * i + k];
  return out;
}

const garments = data.garments.map((garment) => ({
  name: garment.name,
  before: floats(garment.before),
  after: floats(garment.after),
  triangles: columns(numbers(garment.triangles)).map((column) => Uint32Array.from(column)),
  fields: garment.fields.map((field) => ({ ...field, values: floats(field.values) })),
  hinge: garment.hinge ? numbers(garment.hinge) : null,
  hinges: garment.hinges,
  frames: garment.frames.map((frame) => frame),
  low: garment.frame_low,
  size: garment.frame_size,
}));

// One legend for all, so that colours beside each other compare.
for (const name of new Set(garments.flatMap((garment) => garment.fields.map((field) => field.name)))) {
  const alike = garments.flatMap((garment) => garment.fields.filter((field) => field.name === name));
  const limits = [Math.min(...alike.map((f) => f.limits[0])), Math.max(...alike.map((f) => f.limits[1]))];
  for (const field of alike) field.limits = limits;
}

function worn(garment, share) {
  const out = new Float32Array(garment.before.length);
  for (let i = 0; i < out.length; i++) out[i] = garment.before[i] + share * (garment.after[i] - garment.before[i]);
  return out;
}

// Frames are kept as shares of their common box, in 16 bits.
function frame(garment, number) {
  const shares = new Uint16Array(bytes(garment.frames[Math.min(number, garment.frames.length - 1)]));
  const out = new Float32Array(shares.length);
  for (let i = 0; i < out.length; i++) out[i] = garment.low[i % 3] + garment.size[i % 3] * shares[i] / 65535;
  return out;
}

function box(list) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const xyz of list) for (let i = 0; i < xyz.length; i++) {
    low[i % 3] = Math.min(low[i % 3], xyz[i]);
    high[i % 3] = Math.max(high[i % 3], xyz[i]);
  }
  return [low, high];
}

// One scale for all scenes, so that garments beside each other compare.
function ranges(shapes) {
  const boxes = shapes.map((list) => box(list));
  const half = 0.5 * Math.max(...boxes.flatMap(([low, high]) => low.map((l, k) => high[k] - l)), 1e-6);
  return boxes.map(([low, high]) => low.map((l, k) => [0.5 * (l + high[k]) - half, 0.5 * (l + high[k]) + half]));
}

function says(garment) {
  return Array.from({ length: garment.before.length / 3 }, (_, p) => {
    const lines = ['point ' + p];
    for (const field of garment.fields) if (field.values.length === garment.before.length / 3) {
      lines.push(field.title + ' ' + field.values[p].toPrecision(3) + ' ' + field.unit);
    }
    const h = garment.hinge ? garment.hinge[p] : 0xffffffff;
    if (h !== 0xffffffff) {
      const hinge = garment.hinges[h];
      lines.push('hinge ' + hinge[0] + ' (points ' + hinge[1] + ', ' + hinge[2] + ')');
      lines.push('rest angle ' + hinge[4].toFixed(1) + '°, was ' + hinge[3].toFixed(1) + '°');
      lines.push('stiffness × ' + hinge[5].toFixed(2));
    }
    return lines.join('<br>');
  });
}

const scenes = garments.map((garment) => {
  const section = document.createElement('section');
  const title = document.createElement('h2');
  title.textContent = garment.name;
  const div = document.createElement('div');
  div.className = 'scene';
  section.append(title, div);
  find('scenes').append(section);
  return div;
});

function paint(garment, name) {
  const field = garment.fields.find((field) => field.name === name);
  if (!field) return { intensity: [new Float32Array(garment.before.length / 3)], colorscale: [[[0, '#b9a58c'], [1, '#b9a58c']]], cmin: 0, cmax: 1, showscale: false };
  const perPoint = field.values.length === garment.before.length / 3;
  const unit = field.unit ? ' [' + field.unit + ']' : '';
  return {
    intensity: [field.values], intensitymode: perPoint ? 'vertex' : 'cell',
    colorscale: [data.maps[field.map]], cmin: field.limits[0], cmax: field.limits[1], showscale: true,
    colorbar: [{ title: { text: field.title + unit }, thickness: 14, len: 0.7 }],
  };
}

const names = [...new Map([['shape', 'shape']].concat(garments.flatMap((g) => g.fields.map((f) => [f.name, f.title])))).entries()];
for (const [name, title] of names) find('show').add(new Option(title, name));
if (names.some(([name]) => name === data.show)) find('show').value = data.show;

// Narrow scenes look from farther away.
const away = garments.length > 1 ? 1.35 : 1;
const still = ranges(garments.map((g) => [g.before, g.after]));
const moving = ranges(garments.map((g) => g.frames.map((_, i) => frame(g, i))));
const layout = (range) => ({
  margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: '#f4f3f0', showlegend: false,
  scene: {
    aspectmode: 'cube', dragmode: 'orbit',
    camera: { up: { x: 0, y: 1, z: 0 }, eye: data.lies ? { x: 0, y: 1.15 * away, z: 0.75 * away } : { x: 0.25 * away, y: 0.15 * away, z: 1.25 * away } },
    xaxis: { visible: false, range: range[0] }, yaxis: { visible: false, range: range[1] }, zaxis: { visible: false, range: range[2] },
  },
});

function place(k, xyz, range) {
  const [x, y, z] = columns(xyz);
  return Plotly.update(scenes[k], { x: [x], y: [y], z: [z] }, {
    'scene.xaxis.range': range[0], 'scene.yaxis.range': range[1], 'scene.zaxis.range': range[2],
  }, [0]);
}

function showWorn() {
  const share = Number(find('worn').value);
  find('worn-says').textContent = Math.round(100 * share) + ' %';
  return Promise.all(garments.map((garment, k) => place(k, worn(garment, share), still[k])));
}

function showFrame() {
  const number = Number(find('frame').value);
  find('frame-says').textContent = data.frame_names[number] || String(number);
  return Promise.all(garments.map((garment, k) => garment.frames.length ? place(k, frame(garment, number), moving[k]) : null));
}

function showColours() {
  return Promise.all(garments.map((garment, k) => Plotly.restyle(scenes[k], paint(garment, find('show').value), [0])));
}

// Turning one garment turns the others.
let following = false;
function follow(k) {
  scenes[k].on('plotly_relayout', async (change) => {
    const camera = change['scene.camera'];
    if (!camera || following) return;
    following = true;
    await Promise.all(scenes.map((scene, j) => j === k ? null : Plotly.relayout(scene, { 'scene.camera': camera })));
    following = false;
  });
}

async function start() {
  await Promise.all(garments.map((garment, k) => {
    const [x, y, z] = columns(garment.after);
    const [i, j, l] = garment.triangles;
    const mesh = {
      type: 'mesh3d', x, y, z, i, j, k: l, flatshading: false, text: says(garment), hoverinfo: 'text',
      lighting: { ambient: 0.55, diffuse: 0.75, specular: 0.05, roughness: 0.9, fresnel: 0.05 },
      lightposition: { x: 1000, y: 3000, z: 4000 },
    };
    return Plotly.newPlot(scenes[k], [mesh], layout(still[k]), { responsive: true, displaylogo: false });
  }));
  await showColours();
  await showWorn();
  scenes.forEach((_, k) => follow(k));
  find('show').addEventListener('change', showColours);
  find('worn').addEventListener('input', showWorn);
  const count = Math.max(0, ...garments.map((garment) => garment.frames.length));
  if (count > 0) {
    find('time').hidden = false;
    find('frame').max = String(count - 1);
    find('frame').addEventListener('input', showFrame);
    let playing = false;
    find('play').addEventListener('click', async () => {
      playing = !playing;
      find('play').textContent = playing ? 'stop' : 'play';
      while (playing) {
        const next = Number(find('frame').value) + 1;
        find('frame').value = String(next < count ? next : 0);
        await showFrame();
        await new Promise((done) => setTimeout(done, 80));
      }
    });
  }
  // The page can be opened in a given state: OUT.html#show=curvature&worn=0.5, or #frame=12.
  const wish = new URLSearchParams(location.hash.slice(1));
  if (wish.has('show')) { find('show').value = wish.get('show'); await showColours(); }
  if (wish.has('worn')) { find('worn').value = wish.get('worn'); await showWorn(); }
  if (wish.has('frame') && count > 0) { find('frame').value = wish.get('frame'); await showFrame(); }
  document.body.dataset.ready = 'yes';
}
start().catch((error) => fail(String(error)));
