// Draws the data block of the page: one scene per garment, with colours, the slider of the worn shape, and frames.
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
  now: floats(garment.after),
  low: garment.frame_low,
  size: garment.frame_size,
}));

// One legend for all garments, so that their colours can be compared.
for (const name of new Set(garments.flatMap((garment) => garment.fields.map((field) => field.name)))) {
  const same = garments.flatMap((garment) => garment.fields.filter((field) => field.name === name));
  const limits = [Math.min(...same.map((f) => f.limits[0])), Math.max(...same.map((f) => f.limits[1]))];
  for (const field of same) field.limits = limits;
}

function worn(garment, weight) {
  const out = new Float32Array(garment.before.length);
  for (let i = 0; i < out.length; i++) out[i] = garment.before[i] + weight * (garment.after[i] - garment.before[i]);
  return out;
}

// Frames are 16-bit fractions of their common bounding box.
function frame(garment, number) {
  const fractions = new Uint16Array(bytes(garment.frames[Math.min(number, garment.frames.length - 1)]));
  const out = new Float32Array(fractions.length);
  for (let i = 0; i < out.length; i++) out[i] = garment.low[i % 3] + garment.size[i % 3] * fractions[i] / 65535;
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

// One scale for all scenes, so that sizes can be compared.
function ranges(shapes) {
  const boxes = shapes.map((list) => box(list));
  const half = 0.5 * Math.max(...boxes.flatMap(([low, high]) => low.map((l, k) => high[k] - l)), 1e-6);
  return boxes.map(([low, high]) => low.map((l, k) => [0.5 * (l + high[k]) - half, 0.5 * (l + high[k]) + half]));
}

function hoverTexts(garment) {
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

// Light from the upper left for the shape: the light of the library is at the camera and shows no wrinkles.
const lightDirection = [-0.55, 0.7, 0.45];
function light(garment, xyz) {
  const normal = new Float32Array(xyz.length);
  const [a, b, c] = garment.triangles;
  for (let t = 0; t < a.length; t++) {
    const [p, q, r] = [3 * a[t], 3 * b[t], 3 * c[t]];
    const u = [0, 1, 2].map((k) => xyz[q + k] - xyz[p + k]), v = [0, 1, 2].map((k) => xyz[r + k] - xyz[p + k]);
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    for (const corner of [p, q, r]) for (let k = 0; k < 3; k++) normal[corner + k] += n[k];
  }
  return Float32Array.from({ length: xyz.length / 3 }, (_, i) => {
    const n = [normal[3 * i], normal[3 * i + 1], normal[3 * i + 2]];
    const length = Math.hypot(...n) || 1;
    return 0.5 + 0.5 * (n[0] * lightDirection[0] + n[1] * lightDirection[1] + n[2] * lightDirection[2]) / length;
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
  if (!field) return {
    intensity: [light(garment, garment.now)], intensitymode: 'vertex', cmin: 0.2, cmax: 0.95, showscale: false,
    colorscale: [[[0, '#2b2723'], [0.5, '#a08d76'], [1, '#f3ebdf']]],
  };
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

// Narrow scenes need a more distant camera.
const distance = garments.length > 1 ? 1.15 : 1;
const shapeRanges = ranges(garments.map((g) => [g.before, g.after]));
const frameRanges = ranges(garments.map((g) => g.frames.map((_, i) => frame(g, i))));
const layout = (range) => ({
  margin: { l: 0, r: 0, t: 0, b: 0 }, paper_bgcolor: '#f4f3f0', showlegend: false,
  scene: {
    aspectmode: 'cube', dragmode: 'orbit',
    camera: { up: { x: 0, y: 1, z: 0 }, eye: data.lies ? { x: 0, y: 0.95 * distance, z: 0.62 * distance } : { x: 0.2 * distance, y: 0.12 * distance, z: 0.95 * distance } },
    xaxis: { visible: false, range: range[0] }, yaxis: { visible: false, range: range[1] }, zaxis: { visible: false, range: range[2] },
  },
});

function setPositions(k, xyz, range) {
  const [x, y, z] = columns(xyz);
  garments[k].now = xyz;
  const shape = find('show').value === 'shape' ? paint(garments[k], 'shape') : {};
  return Plotly.update(scenes[k], { x: [x], y: [y], z: [z], ...shape }, {
    'scene.xaxis.range': range[0], 'scene.yaxis.range': range[1], 'scene.zaxis.range': range[2],
  }, [0]);
}

function showWorn() {
  const weight = Number(find('worn').value);
  find('worn-value').textContent = Math.round(100 * weight) + ' %';
  return Promise.all(garments.map((garment, k) => setPositions(k, worn(garment, weight), shapeRanges[k])));
}

function showFrame() {
  const number = Number(find('frame').value);
  find('frame-value').textContent = data.frame_names[number] || String(number);
  return Promise.all(garments.map((garment, k) => garment.frames.length ? setPositions(k, frame(garment, number), frameRanges[k]) : null));
}

function showColours() {
  return Promise.all(garments.map((garment, k) => Plotly.restyle(scenes[k], paint(garment, find('show').value), [0])));
}

// Cameras of all scenes move together.
let synchronising = false;
function synchronise(k) {
  scenes[k].on('plotly_relayout', async (change) => {
    const camera = change['scene.camera'];
    if (!camera || synchronising) return;
    synchronising = true;
    await Promise.all(scenes.map((scene, j) => j === k ? null : Plotly.relayout(scene, { 'scene.camera': camera })));
    synchronising = false;
  });
}

async function start() {
  await Promise.all(garments.map((garment, k) => {
    const [x, y, z] = columns(garment.after);
    const [i, j, l] = garment.triangles;
    const mesh = {
      type: 'mesh3d', x, y, z, i, j, k: l, flatshading: false, text: hoverTexts(garment), hoverinfo: 'text',
      lighting: { ambient: 0.75, diffuse: 0.3, specular: 0.02, roughness: 0.9, fresnel: 0 },
    };
    return Plotly.newPlot(scenes[k], [mesh], layout(shapeRanges[k]), { responsive: true, displaylogo: false });
  }));
  await showColours();
  await showWorn();
  scenes.forEach((_, k) => synchronise(k));
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
  const state = new URLSearchParams(location.hash.slice(1));
  const oldNames = { 'rest-angle': 'rest-angle-change' };
  if (state.has('show')) { find('show').value = oldNames[state.get('show')] || state.get('show'); await showColours(); }
  if (state.has('worn')) { find('worn').value = state.get('worn'); await showWorn(); }
  if (state.has('frame') && count > 0) { find('frame').value = state.get('frame'); await showFrame(); }
  document.body.dataset.ready = 'yes';
}
start().catch((error) => fail(String(error)));
