// The stage: one canvas with a pane per garment. All panes share the direction and distance of the camera, so that sizes can
// be compared; each looks at the middle of its own garment. A pane is drawn twice where the wipe divides it.

const VIEWS = {
  auto: null,
  front: [0, 4],
  back: [180, 4],
  left: [90, 4],
  right: [-90, 4],
  top: [0, 89],
};
/** Elevation from which lying garments are seen, and from which lying and standing ones are seen together [degrees]. */
const LYING_ELEVATION = 52;
const MIXED_ELEVATION = 34;
/** Part of a pane that garments fill. */
const FILL = 0.86;

class Stage {
  constructor(canvas, panes, garments) {
    this.canvas = canvas;
    this.garments = garments;
    this.wipe = null;
    this.weight = 1;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.toneMapping = THREE.NeutralToneMapping;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.autoUpdate = false;
    this.renderer.shadowMap.type = THREE.VSMShadowMap;
    this.renderer.setClearColor(0, 0);
    this.renderer.autoClear = false;
    this.camera = new THREE.PerspectiveCamera(28, 1, 0.01, 100);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener('change', () => this.invalidate(false));
    this.environment = new THREE.PMREMGenerator(this.renderer).fromScene(new THREE.RoomEnvironment(), 0.03).texture;
    this.panes = garments.map((garment) => this.addPane(panes, garment));
    this.marker = new THREE.Mesh(new THREE.SphereGeometry(1, 12, 8), new THREE.MeshBasicMaterial({ color: 0xe0452c, toneMapped: false, depthTest: false }));
    this.marker.renderOrder = 2;
    this.reach = Math.max(...this.panes.map((pane) => pane.radius), 1e-6);
    this.setView('auto');
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  addPane(list, garment) {
    const element = document.createElement('div');
    element.className = 'pane';
    const heading = document.createElement('h2');
    heading.textContent = garment.name;
    element.append(heading);
    list.append(element);
    const box = new THREE.Box3().setFromPoints(garment.shown);
    const centre = box.getCenter(new THREE.Vector3());
    const radius = 0.5 * box.getSize(new THREE.Vector3()).length();
    // Shadows fall within what any motion reaches.
    const all = garment.motions().flatMap((motion) => garment.reach(motion));
    const wide = Math.max(radius, ...all.map((p) => p.distanceTo(centre)));
    const scene = new THREE.Scene();
    scene.environment = this.environment;
    scene.environmentIntensity = 0.34;
    scene.add(garment.group);
    // Light that grazes the cloth shows its wrinkles: low from the left on a lying garment, from the side on a standing one.
    const key = new THREE.DirectionalLight(0xfff1e2, 2.6);
    key.position.set(...(garment.item.lies ? [-1.35, 0.95, 0.55] : [-1.5, 1.1, 0.9])).multiplyScalar(2 * radius);
    key.castShadow = true;
    key.shadow.mapSize.set(2048, 2048);
    key.shadow.radius = 7;
    key.shadow.blurSamples = 20;
    Object.assign(key.shadow.camera, { left: -wide * 1.2, right: wide * 1.2, top: wide * 1.2, bottom: -wide * 1.2, near: 0.1 * radius, far: 8 * wide });
    key.shadow.bias = -0.0006;
    key.shadow.normalBias = 0.003 * radius;
    const fill = new THREE.DirectionalLight(0xe6eeff, garment.item.lies ? 0.75 : 0.6);
    fill.position.set(...(garment.item.lies ? [0.5, 1.6, 0.9] : [0.9, 0.5, 1.4]));
    const rim = new THREE.DirectionalLight(0xdfeaff, 0.5);
    rim.position.set(1.4, 0.4, -0.9);
    scene.add(key, key.target, fill, rim);
    const ground = new THREE.Mesh(new THREE.PlaneGeometry(30 * radius, 30 * radius), new THREE.ShadowMaterial({ opacity: 0.16 }));
    ground.rotation.x = -Math.PI / 2;
    ground.receiveShadow = true;
    scene.add(ground);
    return { element, scene, ground, radius, low: box.min.y, points: [], garment, rect: null };
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    const count = this.panes.length;
    // The grid whose cells are closest to square.
    const columns = [...Array(count).keys()].map((k) => k + 1)
      .sort((a, b) => this.cell(b, width, height) - this.cell(a, width, height))[0];
    const rows = Math.ceil(count / columns);
    this.panes.forEach((pane, k) => {
      const [column, row] = [k % columns, Math.floor(k / columns)];
      const inRow = row === rows - 1 ? count - columns * (rows - 1) : columns;
      const [x, y] = [Math.round(column * width / inRow), Math.round(row * height / rows)];
      pane.rect = { x, y, width: Math.round((column + 1) * width / inRow) - x, height: Math.round((row + 1) * height / rows) - y };
      Object.assign(pane.element.style, { left: x + 'px', top: y + 'px', width: pane.rect.width + 'px', height: pane.rect.height + 'px' });
      pane.element.classList.toggle('below', row > 0 && column === 0);
    });
    if (this.fitted) this.fit(); else this.invalidate();
  }

  cell(columns, width, height) {
    const rows = Math.ceil(this.panes.length / columns);
    return Math.min(width / columns, height / rows);
  }

  setView(name) {
    const [azimuth, elevation] = VIEWS[name] ?? this.ownView();
    const [a, e] = [azimuth, elevation].map((x) => x * Math.PI / 180);
    this.direction = new THREE.Vector3(Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e));
    this.camera.position.copy(this.direction);
    this.camera.lookAt(0, 0, 0);
    this.fit();
  }

  /** Direction from which these garments are seen best. */
  ownView() {
    const lying = this.garments.filter((garment) => garment.item.lies).length;
    if (lying === this.garments.length) return [0, LYING_ELEVATION];
    return [18, lying ? MIXED_ELEVATION : 8];
  }

  /** Fits to what the garments reach in a motion, or to their still shapes. */
  setReach(motion) {
    for (const pane of this.panes) {
      const points = pane.garment.reach(motion);
      const centre = new THREE.Box3().setFromPoints(points).getCenter(new THREE.Vector3());
      pane.garment.group.position.copy(centre).negate();
      pane.ground.position.y = pane.low - centre.y - 0.004 * pane.radius;
      pane.points = points.map((p) => p.clone().sub(centre));
    }
    this.fit();
  }

  /** Puts the camera where every garment fills its pane, in the direction from which it looks. */
  fit() {
    this.fitted = true;
    this.controls.target.set(0, 0, 0);
    const towards = this.camera.position.clone().normalize();
    this.camera.position.copy(towards);
    this.camera.lookAt(0, 0, 0);
    this.camera.updateMatrixWorld(true);
    const [right, up, back] = [0, 1, 2].map((k) => new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, k));
    const tangent = FILL * Math.tan(this.camera.fov * Math.PI / 360);
    let distance = 1e-3;
    for (const pane of this.panes) {
      if (!pane.rect) continue;
      const aspect = pane.rect.width / pane.rect.height;
      for (const p of pane.points) {
        const z = p.dot(back);
        distance = Math.max(distance, z + Math.abs(p.dot(right)) / (tangent * aspect), z + Math.abs(p.dot(up)) / tangent);
      }
    }
    this.camera.position.multiplyScalar(distance);
    this.camera.near = Math.max(distance - 3 * this.reach, 0.02 * distance);
    this.camera.far = distance + 12 * this.reach;
    this.controls.minDistance = 0.1 * this.reach;
    this.controls.maxDistance = 20 * this.reach;
    this.controls.update();
    this.fitted = true;
    this.invalidate();
  }

  /** Draws soon; shadows are drawn again if shapes have changed. */
  invalidate(shapes = true) {
    this.shapesChanged ||= shapes;
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  draw() {
    const { renderer } = this;
    const height = this.canvas.parentElement.clientHeight;
    renderer.setScissorTest(false);
    renderer.clear();
    renderer.setScissorTest(true);
    for (const pane of this.panes) {
      if (!pane.rect) continue;
      const { x, y, width, height: tall } = pane.rect;
      // From below, the ground would hide the garment.
      pane.ground.visible = this.camera.position.y > this.controls.target.y;
      this.camera.aspect = width / tall;
      this.camera.updateProjectionMatrix();
      renderer.setViewport(x, height - y - tall, width, tall);
      const cut = this.wipe === null ? 0 : Math.round(this.wipe * width);
      const strips = this.wipe === null ? [[0, width, this.weight]] : [[0, cut, 0], [cut, width - cut, 1]];
      for (const [left, wide, weight] of strips) {
        if (wide <= 0) continue;
        pane.garment.setWeight(weight);
        renderer.shadowMap.needsUpdate = this.shapesChanged || this.wipe !== null;
        renderer.setScissor(x + left, height - y - tall, wide, tall);
        renderer.render(pane.scene, this.camera);
      }
    }
    this.shapesChanged = false;
    this.onDraw?.();
  }

  /** What is under the pointer, in pixels of the page. */
  pick(clientX, clientY) {
    const frame = this.canvas.getBoundingClientRect();
    const [px, py] = [clientX - frame.left, clientY - frame.top];
    const pane = this.panes.find(({ rect }) => rect && px >= rect.x && px < rect.x + rect.width && py >= rect.y && py < rect.y + rect.height);
    if (!pane) return null;
    const across = (px - pane.rect.x) / pane.rect.width;
    this.camera.aspect = pane.rect.width / pane.rect.height;
    this.camera.updateProjectionMatrix();
    const raycaster = new THREE.Raycaster();
    raycaster.setFromCamera(new THREE.Vector2(2 * across - 1, 1 - 2 * (py - pane.rect.y) / pane.rect.height), this.camera);
    pane.garment.setWeight(this.wipe === null ? this.weight : across < this.wipe ? 0 : 1);
    pane.garment.group.updateMatrixWorld(true);
    const found = pane.garment.pick(raycaster);
    return found && { ...found, pane };
  }

  /** Marks a picked point, or none. */
  mark(found) {
    this.marker.removeFromParent();
    if (found) {
      this.marker.position.copy(found.position);
      this.marker.scale.setScalar(0.006 * this.camera.position.distanceTo(found.position));
      found.pane.scene.add(this.marker);
    }
    this.invalidate();
  }
}
