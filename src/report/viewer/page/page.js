// Reads the data block, loads the garments, and connects the controls with the stage.

window.addEventListener('error', (event) => fail(event.message));
window.addEventListener('unhandledrejection', (event) => fail(String(event.reason?.message ?? event.reason)));

function fail(message) {
  const element = document.getElementById('error');
  element.hidden = false;
  element.textContent = `This page cannot be shown: ${message}`;
  document.body.dataset.error = message;
}

const find = (id) => document.getElementById(id);
const KEYS = [
  ['F B L R T', 'front, back, left, right, top'], ['0', 'all in view'], ['C', 'next colour'], ['W', 'before / after'],
  ['M', 'triangles'], ['Space', 'play'], ['\u2190 \u2192', 'one frame'], ['D', 'light or dark'], ['?', 'keys'],
];

class Page {
  constructor(data, garments) {
    this.data = data;
    this.garments = garments;
    this.stage = new Stage(find('canvas'), find('panes'), garments);
    this.frameNames = data.frame_names;
    this.limits = this.commonLimits();
    this.addColours();
    this.addViews();
    this.addWear();
    this.addMotions();
    this.addHover();
    this.addKeys();
    find('wire').onclick = () => this.setWire(!this.wire);
    find('fit').onclick = () => this.stage.fit();
    find('dark').onclick = () => this.setDark(!this.dark);
    find('keys').onclick = () => { find('help').hidden = !find('help').hidden; };
    this.applyAddress();
  }

  /** One legend for all garments, so that their colours can be compared. */
  commonLimits() {
    const limits = new Map();
    for (const field of this.garments.flatMap((garment) => garment.fields)) {
      const own = limits.get(field.name) ?? { ...field, low: Infinity, high: -Infinity, below: false, above: false };
      own.low = Math.min(own.low, field.limits[0]);
      own.high = Math.max(own.high, field.limits[1]);
      limits.set(field.name, own);
    }
    for (const own of limits.values()) {
      for (const garment of this.garments) {
        const field = garment.fields.find((other) => other.name === own.name);
        for (const value of field?.values ?? []) {
          own.below ||= value < own.low - 1e-6 * Math.abs(own.low);
          own.above ||= value > own.high + 1e-6 * Math.abs(own.high);
        }
      }
    }
    return limits;
  }

  addColours() {
    const names = [...this.limits.keys()];
    find('show').replaceChildren(new Option('Material', 'shape'), ...names.map((name) => new Option(this.limits.get(name).title, name)));
    find('show').onchange = () => this.setColour(find('show').value);
  }

  setColour(name) {
    const field = this.limits.get(name);
    find('show').value = field ? name : 'shape';
    for (const garment of this.garments) garment.setField(name, field && [field.low, field.high]);
    find('legend').hidden = !field;
    if (field) this.drawLegend(field);
    this.stage.invalidate();
  }

  drawLegend(field) {
    find('legend-title').textContent = field.unit ? `${field.title} [${field.unit}]` : field.title;
    const bar = find('legend-bar').getContext('2d');
    for (let x = 0; x < 256; x++) {
      const [r, g, b] = colourAt(this.data.maps[field.map], x / 255);
      bar.fillStyle = `rgb(${r.toFixed(1)} ${g.toFixed(1)} ${b.toFixed(1)})`;
      bar.fillRect(x, 0, 1, 1);
    }
    const digits = Math.min(Math.max(2 - Math.floor(Math.log10(field.high - field.low)), 0), 6);
    const text = (x) => String(Number(x.toFixed(digits))).replace('-', '\u2212');
    const numbers = [field.low, 0.5 * (field.low + field.high), field.high].map(text);
    if (field.below) numbers[0] = `\u2264 ${numbers[0]}`;
    if (field.above) numbers[2] = `\u2265 ${numbers[2]}`;
    find('legend-numbers').replaceChildren(...numbers.map((number) => Object.assign(document.createElement('span'), { textContent: number })));
  }

  addViews() {
    const title = (name) => (name === 'auto' ? 'As it lies' : name[0].toUpperCase() + name.slice(1));
    find('view').replaceChildren(...Object.keys(VIEWS).map((name) => new Option(title(name), name)));
    if (!this.garments.every((garment) => garment.item.lies)) find('view').options[0].text = 'Turned';
    find('view').onchange = () => this.stage.setView(find('view').value);
  }

  setView(name) {
    find('view').value = name;
    this.stage.setView(name);
  }

  addWear() {
    const can = this.garments.some((garment) => garment.canBlend);
    find('worn').closest('label').hidden = find('wipe').hidden = !can;
    find('worn').oninput = () => this.setWeight(Number(find('worn').value));
    find('wipe').onclick = () => this.setWipe(this.stage.wipe === null ? 0.5 : null);
    for (const pane of this.stage.panes) {
      const [handle, before, after] = ['handle', 'side', 'side'].map((name) => Object.assign(document.createElement('div'), { className: name, hidden: true }));
      before.textContent = 'before';
      after.textContent = 'after';
      pane.wipe = { handle, before, after };
      pane.element.append(handle, before, after);
      handle.onpointerdown = (event) => handle.setPointerCapture(event.pointerId);
      handle.onpointermove = (event) => {
        if (!handle.hasPointerCapture(event.pointerId)) return;
        const rect = pane.element.getBoundingClientRect();
        this.setWipe(Math.min(Math.max((event.clientX - rect.left) / rect.width, 0), 1));
      };
    }
  }

  setWeight(weight) {
    if (this.stage.wipe !== null) this.setWipe(null);
    this.stage.weight = weight;
    find('worn').value = weight;
    find('worn-value').textContent = `${Math.round(100 * weight)} %`;
    this.stage.invalidate();
  }

  setWipe(fraction) {
    this.stage.wipe = fraction;
    find('wipe').setAttribute('aria-pressed', String(fraction !== null));
    for (const { wipe } of this.stage.panes) {
      for (const element of Object.values(wipe)) element.hidden = fraction === null;
      const percent = 100 * (fraction ?? 0);
      wipe.handle.style.left = `${percent}%`;
      Object.assign(wipe.before.style, { right: `calc(${100 - percent}% + 12px)` });
      Object.assign(wipe.after.style, { left: `calc(${percent}% + 12px)` });
    }
    this.stage.invalidate();
  }

  setWire(on) {
    this.wire = on;
    find('wire').setAttribute('aria-pressed', String(on));
    for (const garment of this.garments) garment.setWire(on);
    this.stage.invalidate();
  }

  setDark(on) {
    this.dark = on;
    document.documentElement.classList.toggle('dark', on);
    find('dark').textContent = on ? 'Light' : 'Dark';
    for (const pane of this.stage.panes) pane.ground.material.opacity = on ? 0.4 : 0.16;
    for (const part of this.garments.flatMap((garment) => garment.parts)) part.wire.material.color.set(on ? 0xe8e8e6 : 0x1a1c20);
    this.stage.invalidate();
  }

  addMotions() {
    const clips = new Map();
    for (const garment of this.garments) {
      for (const clip of garment.clips) clips.set(clip.name, Math.max(clips.get(clip.name) ?? 0, clip.duration));
    }
    this.motions = [{ title: 'Still', length: 0 }];
    if (this.frameNames.length) this.motions.push({ title: 'Frames of the bake', frames: true, length: this.frameNames.length - 1 });
    for (const [name, length] of clips) this.motions.push({ title: `Clip: ${name || 'unnamed'}`, clip: name, length });
    find('time').hidden = this.motions.length < 2;
    find('motion').replaceChildren(...this.motions.map((motion, k) => new Option(motion.title, k)));
    find('motion').onchange = () => this.setMotion(Number(find('motion').value));
    find('frame').oninput = () => { this.pause(); this.setTime(Number(find('frame').value)); };
    find('play').onclick = () => (this.timer ? this.pause() : this.play());
    this.setMotion(0);
  }

  setMotion(index) {
    this.pause();
    this.motion = this.motions[index] ?? this.motions[0];
    find('motion').value = this.motions.indexOf(this.motion);
    this.stage.setReach(this.motion);
    const moves = this.motion.length > 0;
    for (const id of ['play', 'frame', 'frame-value']) find(id).hidden = !moves;
    find('frame').max = this.motion.length;
    find('frame').step = this.motion.frames ? 1 : 'any';
    if (moves) this.setTime(0);
    else for (const garment of this.garments) { garment.setFrame(-1); garment.setClip(-1, 0, this.stage.weight); }
    this.stage.invalidate();
  }

  setTime(time) {
    this.time = time;
    find('frame').value = time;
    const { frames, clip } = this.motion;
    find('frame-value').textContent = frames ? `${this.frameNames[Math.round(time)]}` : `${time.toFixed(2)} s`;
    for (const garment of this.garments) {
      garment.setFrame(frames ? Math.round(time) : -1);
      garment.setClip(clip === undefined ? -1 : garment.clips.findIndex((own) => own.name === clip), time, this.stage.weight);
    }
    this.stage.invalidate();
  }

  play() {
    if (!this.motion.length) this.setMotion(1);
    find('play').textContent = 'Pause';
    let last = performance.now();
    const step = (now) => {
      const rate = this.motion.frames ? 10 : 1;
      const next = this.time + rate * (now - last) / 1000;
      last = now;
      this.time = next > this.motion.length ? 0 : next;
      this.setTime(this.time);
      this.timer = requestAnimationFrame(step);
    };
    this.timer = requestAnimationFrame(step);
  }

  pause() {
    cancelAnimationFrame(this.timer);
    this.timer = 0;
    find('play').textContent = 'Play';
  }

  addHover() {
    const canvas = find('canvas');
    let event = null;
    const look = () => {
      const at = event;
      event = null;
      if (!at || at.buttons) return this.showTip(null);
      this.showTip(this.stage.pick(at.clientX, at.clientY), at.clientX, at.clientY);
    };
    canvas.addEventListener('pointermove', (move) => {
      if (!event) requestAnimationFrame(look);
      event = move;
    });
    canvas.addEventListener('pointerleave', () => this.showTip(null));
  }

  showTip(found, x, y) {
    const tip = find('tip');
    if (!found && tip.hidden) return;
    tip.hidden = !found;
    this.stage.mark(found);
    if (!found) return;
    tip.textContent = found.text;
    const stage = find('stage').getBoundingClientRect();
    const { offsetWidth: width, offsetHeight: height } = tip;
    tip.style.left = `${Math.min(x - stage.left + 16, stage.width - width - 8)}px`;
    tip.style.top = `${Math.max(Math.min(y - stage.top + 16, stage.height - height - 8), 8)}px`;
  }

  addKeys() {
    const row = ([key, text]) => `<tr><td><kbd>${key}</kbd></td><td>${text}</td></tr>`;
    find('help').innerHTML = `<table>${KEYS.map(row).join('')}</table>drag: turn; wheel or two fingers: zoom; right button: move`;
    const views = { f: 'front', b: 'back', l: 'left', r: 'right', t: 'top' };
    const step = (by) => this.motion.length && this.setTime(Math.min(Math.max(this.time + by * (this.motion.frames ? 1 : 1 / 30), 0), this.motion.length));
    const actions = {
      0: () => this.stage.fit(), w: () => find('wipe').click(), m: () => find('wire').click(), d: () => find('dark').click(),
      '?': () => find('keys').click(), ' ': () => find('play').click(), arrowleft: () => step(-1), arrowright: () => step(1),
      c: () => { const { options, selectedIndex } = find('show'); this.setColour(options[(selectedIndex + 1) % options.length].value); },
    };
    window.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || /^(INPUT|SELECT)$/.test(event.target.tagName)) return;
      const key = event.key.toLowerCase();
      if (key === ' ' && event.target.tagName === 'BUTTON') return;
      if (views[key]) this.setView(views[key]); else if (actions[key]) actions[key](); else return;
      event.preventDefault();
    });
  }

  /** State from the address, such as #show=curvature&worn=0.5&view=back, or the defaults. */
  applyAddress() {
    const state = new URLSearchParams(location.hash.slice(1));
    const prefersDark = window.matchMedia('(prefers-color-scheme: dark)').matches;
    this.setDark(state.has('dark') ? state.get('dark') !== '0' : prefersDark);
    this.setColour(state.get('show') ?? this.data.show);
    this.setWeight(Number(state.get('worn') ?? 1));
    this.setWire(state.get('wire') === '1');
    if (state.has('wipe')) this.setWipe(Number(state.get('wipe')));
    if (state.has('view')) this.setView(state.get('view'));
    if (state.has('motion')) this.setMotion(Number(state.get('motion')));
    if (state.has('time')) this.setTime(Number(state.get('time')));
  }
}

(async () => {
  const began = performance.now();
  const data = JSON.parse(find('data').textContent);
  const garments = await Promise.all(data.garments.map((item) => Garment.load(item, data.maps)));
  const page = new Page(data, garments);
  page.stage.onDraw = () => {
    document.body.dataset.ready = 'yes';
    document.body.dataset.loadMs ??= String(Math.round(performance.now() - began));
  };
  page.stage.resize();
})();
