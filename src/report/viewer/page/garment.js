// One garment: its GLB as three.js shows it, with the weight of the worn shape, a material for fields, an overlay of its
// triangles, its clips, and the frames of its bake.

function bytesOf(text) {
  const raw = atob(text);
  const out = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) out[i] = raw.charCodeAt(i);
  return out.buffer;
}

/** Colour at a fraction of a map, whose stops are [fraction, [r, g, b]] in sRGB. */
function colourAt(stops, fraction) {
  const x = Math.min(Math.max(fraction, 0), 1) * (stops.length - 1);
  const i = Math.min(Math.floor(x), stops.length - 2);
  const mix = (k) => stops[i][k] + (x - i) * (stops[i + 1][k] - stops[i][k]);
  return [mix(0), mix(1), mix(2)];
}

class Garment {
  static async load(item, maps) {
    const gltf = await new THREE.GLTFLoader().parseAsync(bytesOf(item.glb), '');
    return new Garment(item, maps, gltf);
  }

  constructor(item, maps, gltf) {
    this.name = item.name;
    this.item = item;
    this.maps = maps;
    this.fields = item.fields.map((field) => ({ ...field, values: new Float32Array(bytesOf(field.values)) }));
    this.addVertices(item);
    this.hinge = item.hinge ? new Uint32Array(bytesOf(item.hinge)) : null;
    this.clips = gltf.animations;
    this.mixer = this.clips.length ? new THREE.AnimationMixer(gltf.scene) : null;
    this.group = new THREE.Group();
    this.model = gltf.scene;
    this.group.add(this.model);
    this.parts = this.findParts(gltf);
    this.frameParts = [];
    this.model.traverse((object) => {
      if (!object.isMesh) return;
      object.frustumCulled = false;
      object.castShadow = object.receiveShadow = true;
    });
    for (const part of this.parts) this.addMaterials(part);
    this.setWeight(1);
    this.shown = this.samplePoints();
  }

  /**
   * Vertices of all worn pieces as they are drawn. Those of the file are points; those that the worn surface has beside them, which follow
   * in each piece, are means of three, with a number of their own.
   */
  addVertices(item) {
    const points = new Uint32Array(bytesOf(item.points));
    const [of, own] = [item.added_of, item.added_points].map((text) => new Uint32Array(bytesOf(text)));
    const weights = new Float32Array(bytesOf(item.added_weights));
    const count = item.pieces.reduce((sum, piece) => sum + piece.count + piece.added, 0);
    this.points = new Uint32Array(count);
    this.means = { points: new Uint32Array(3 * count), weights: new Float32Array(3 * count) };
    let [v, file, added] = [0, 0, 0];
    for (const piece of item.pieces) {
      for (let k = 0; k < piece.count; k++, v++, file++) {
        this.points[v] = points[file];
        this.means.points.fill(points[file], 3 * v, 3 * v + 3);
        this.means.weights[3 * v] = 1;
      }
      for (let k = 0; k < piece.added; k++, v++, added++) {
        this.points[v] = own[added];
        for (let j = 0; j < 3; j++) {
          this.means.points[3 * v + j] = points[of[3 * added + j]];
          this.means.weights[3 * v + j] = weights[3 * added + j];
        }
      }
    }
    this.pointCount = this.points.reduce((most, point) => Math.max(most, point + 1), 0);
  }

  /** The value of vertex `v` from those of points; `stride` values each, the one at `offset`. */
  mean(values, v, stride = 1, offset = 0) {
    const { points, weights } = this.means;
    let sum = 0;
    for (let k = 3 * v; k < 3 * v + 3; k++) if (weights[k] > 0) sum += weights[k] * values[stride * points[k] + offset];
    return sum;
  }

  /** The point of the file next to vertex `v`. */
  nearestPoint(v) {
    const { points, weights } = this.means;
    return points[[3 * v, 3 * v + 1, 3 * v + 2].reduce((best, k) => (weights[k] > weights[best] ? k : best))];
  }

  /** Meshes of the worn pieces; each with its vertices among all of them. */
  findParts(gltf) {
    const parts = [];
    const starts = [];
    let start = 0;
    for (const piece of this.item.pieces) {
      starts.push(start);
      start += piece.count + piece.added;
    }
    gltf.scene.traverse((object) => {
      const link = object.isMesh && gltf.parser.associations.get(object);
      if (!link) return;
      const at = this.item.pieces.findIndex((p) => p.mesh === link.meshes && p.primitive === (link.primitives ?? 0));
      if (at < 0) return;
      const count = this.item.pieces[at].count + this.item.pieces[at].added;
      if (object.geometry.attributes.position.count !== count) return;
      parts.push({ mesh: object, start: starts[at], count });
    });
    return parts;
  }

  addMaterials(part) {
    const { mesh } = part;
    part.material = mesh.material;
    part.field = new THREE.MeshStandardMaterial({ vertexColors: true, color: new THREE.Color(0.72, 0.72, 0.72), roughness: 0.95, metalness: 0, side: THREE.DoubleSide, toneMapped: false });
    if (part.material.normalMap) {
      part.field.normalMap = part.material.normalMap;
      part.field.normalScale = part.material.normalScale;
    }
    part.scale = part.material.normalScale?.clone();
    const lines = new THREE.MeshBasicMaterial({ wireframe: true, color: 0x1a1c20, transparent: true, opacity: 0.35 });
    part.wire = mesh.clone(false);
    part.wire.material = lines;
    part.wire.castShadow = false;
    part.wire.visible = false;
    part.wire.raycast = () => {};
    if (mesh.morphTargetInfluences) part.wire.morphTargetInfluences = mesh.morphTargetInfluences;
    mesh.parent.add(part.wire);
    for (const material of [part.material, part.field]) Object.assign(material, { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    const names = mesh.morphTargetDictionary ?? {};
    part.worn = names.worn;
    part.unworn = names.unworn;
    if (part.field.normalMap) part.field.normalScale = part.scale.clone();
  }

  get canBlend() {
    return this.parts.some((part) => part.worn !== undefined || part.unworn !== undefined);
  }

  /** Sets the fraction of the wear that is shown. */
  setWeight(weight) {
    for (const part of this.parts) {
      const influences = part.mesh.morphTargetInfluences;
      if (influences && part.worn !== undefined) influences[part.worn] = weight;
      if (influences && part.unworn !== undefined) influences[part.unworn] = 1 - weight;
      // The map of the wrinkles belongs to the worn shape.
      const map = part.material.normalMap;
      if (map && map.name === 'wrinkles') {
        for (const material of [part.material, part.field]) material.normalScale.copy(part.scale).multiplyScalar(weight);
      }
    }
  }

  /** Colours by the field `name`, or by the materials. */
  setField(name, limits) {
    const field = this.fields.find((own) => own.name === name);
    for (const part of this.parts) {
      part.mesh.material = field ? part.field : part.material;
      if (field) part.mesh.geometry.setAttribute('color', this.colours(field, limits, part));
    }
    for (const [k, mesh] of this.frameParts.entries()) {
      mesh.material = this.parts[k].mesh.material;
      if (field) mesh.geometry.setAttribute('color', this.parts[k].mesh.geometry.attributes.color);
    }
    this.field = field;
  }

  colours(field, [low, high], part) {
    const stops = this.maps[field.map];
    const out = new Float32Array(3 * part.count);
    const colour = new THREE.Color();
    for (let v = 0; v < part.count; v++) {
      const value = this.mean(field.values, part.start + v);
      const [r, g, b] = Number.isFinite(value) ? colourAt(stops, (value - low) / (high - low)) : [150, 150, 150];
      colour.setRGB(r / 255, g / 255, b / 255, THREE.SRGBColorSpace).toArray(out, 3 * v);
    }
    return new THREE.BufferAttribute(out, 3);
  }

  setWire(on) {
    for (const part of this.parts) part.wire.visible = on;
  }

  /** Shows the time `t` of the clip `index`, or the pose of the file for a negative index. */
  setClip(index, t, weight) {
    if (!this.mixer) return;
    this.mixer.stopAllAction();
    const clip = this.clips[index];
    if (clip) {
      const action = this.mixer.clipAction(clip);
      action.play();
      this.mixer.setTime(Math.min(t, clip.duration * 0.99999));
    }
    this.setWeight(weight);
    this.group.updateMatrixWorld(true);
  }

  /** Shows the frame `number` of the bake, or the garment of the file for a negative number. */
  setFrame(number) {
    const { frames } = this.item;
    const on = number >= 0 && frames.length > 0;
    if (on && !this.frameParts.length) this.addFrameParts();
    this.model.visible = !on;
    for (const mesh of this.frameParts) mesh.visible = on;
    if (!on) return;
    const fractions = new Uint16Array(bytesOf(frames[Math.min(number, frames.length - 1)]));
    const x = new Float32Array(fractions.length);
    for (let i = 0; i < x.length; i++) x[i] = this.item.frame_low[i % 3] + this.item.frame_size[i % 3] * fractions[i] / 65535;
    const normals = this.normalsOf(x);
    for (const [k, mesh] of this.frameParts.entries()) {
      const { position, normal } = mesh.geometry.attributes;
      for (let v = 0; v < position.count; v++) {
        const own = this.parts[k].start + v;
        const p = 3 * this.points[own];
        position.setXYZ(v, ...[0, 1, 2].map((j) => this.mean(x, own, 3, j)));
        normal.setXYZ(v, normals[p], normals[p + 1], normals[p + 2]);
      }
      position.needsUpdate = normal.needsUpdate = true;
    }
  }

  addFrameParts() {
    for (const { mesh, count } of this.parts) {
      const geometry = new THREE.BufferGeometry();
      geometry.setIndex(mesh.geometry.index);
      for (const name of ['uv', 'color']) {
        if (mesh.geometry.attributes[name]) geometry.setAttribute(name, mesh.geometry.attributes[name]);
      }
      for (const name of ['position', 'normal']) geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * count), 3));
      const own = new THREE.Mesh(geometry, mesh.material);
      own.frustumCulled = false;
      own.castShadow = own.receiveShadow = true;
      this.group.add(own);
      this.frameParts.push(own);
    }
  }

  normalsOf(x) {
    const sum = new Float32Array(3 * this.pointCount);
    const [a, b, c] = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
    for (const part of this.parts) {
      const index = part.mesh.geometry.index;
      const count = index ? index.count : part.count;
      for (let k = 0; k + 2 < count; k += 3) {
        const corners = [0, 1, 2].map((j) => part.start + (index ? index.getX(k + j) : k + j));
        [a, b, c].forEach((at, j) => at.set(...[0, 1, 2].map((axis) => this.mean(x, corners[j], 3, axis))));
        b.sub(a).cross(c.sub(a));
        for (const p of corners.map((v) => 3 * this.points[v])) for (let j = 0; j < 3; j++) sum[p + j] += b.getComponent(j);
      }
    }
    for (let p = 0; p < sum.length; p += 3) {
      const length = Math.hypot(sum[p], sum[p + 1], sum[p + 2]) || 1;
      for (let j = 0; j < 3; j++) sum[p + j] /= length;
    }
    return sum;
  }

  /** Motions of this garment: none, the frames, each clip. */
  motions() {
    return [{}, { frames: true }, ...this.clips.map((clip) => ({ clip: clip.name }))];
  }

  /** Some positions that the garment takes in a motion. */
  reach({ frames, clip }) {
    if (frames && this.item.frames.length) {
      const [low, size] = [this.item.frame_low, this.item.frame_size];
      return [0, 1, 2, 3, 4, 5, 6, 7].map((k) => new THREE.Vector3(...[0, 1, 2].map((j) => low[j] + ((k >> j) & 1) * size[j])));
    }
    const index = this.clips.findIndex((own) => own.name === clip);
    if (clip === undefined || index < 0) return this.shown;
    const points = [...this.shown];
    for (let k = 0; k <= 6; k++) {
      this.setClip(index, k / 6 * this.clips[index].duration, 1);
      points.push(...this.samplePoints(400));
    }
    this.setClip(-1, 0, 1);
    const shift = this.group.position;
    return points.map((p, k) => (k < this.shown.length ? p : p.sub(shift)));
  }

  /** Some positions of the worn garment in the scene, to fit the camera to. */
  samplePoints(count = 3000) {
    this.group.updateMatrixWorld(true);
    const out = [];
    const meshes = this.parts.length ? this.parts.map((part) => part.mesh) : [];
    if (!meshes.length) this.model.traverse((object) => object.isMesh && meshes.push(object));
    for (const mesh of meshes) {
      const step = Math.max(1, Math.floor(mesh.geometry.attributes.position.count / count));
      for (let v = 0; v < mesh.geometry.attributes.position.count; v += step) {
        out.push(mesh.getVertexPosition(v, new THREE.Vector3()).applyMatrix4(mesh.matrixWorld));
      }
    }
    return out;
  }

  /** What is under the ray: point, position and its description. */
  pick(raycaster) {
    const meshes = this.frameParts.some((mesh) => mesh.visible) ? this.frameParts : this.parts.map((part) => part.mesh);
    for (const mesh of meshes) {
      // Morphs, skins and frames change the bounds.
      mesh.geometry.boundingSphere = mesh.boundingSphere = new THREE.Sphere(new THREE.Vector3(), Infinity);
      if (mesh.boundingBox !== undefined) mesh.boundingBox = null;
      mesh.geometry.boundingBox = null;
    }
    const hit = raycaster.intersectObjects(meshes, false)[0];
    if (!hit) return null;
    const part = this.parts[meshes.indexOf(hit.object)];
    const corners = [hit.face.a, hit.face.b, hit.face.c];
    const at = (v) => hit.object.getVertexPosition(v, new THREE.Vector3()).applyMatrix4(hit.object.matrixWorld);
    const nearest = corners.map((v) => ({ v, x: at(v) })).sort((p, q) => p.x.distanceTo(hit.point) - q.x.distanceTo(hit.point))[0];
    return { position: nearest.x, text: this.describe(this.nearestPoint(part.start + nearest.v)) };
  }

  describe(point) {
    const number = (x) => (Math.abs(x) >= 100 ? x.toFixed(0) : x.toPrecision(3)).replace('-', '\u2212');
    const lines = [`Point ${point}`];
    for (const field of this.fields) {
      const value = field.values[point];
      const text = `${field.title}: ${number(value)}${field.unit ? ' ' + field.unit : ''}`;
      lines.push(field === this.field ? `\u25b8 ${text}` : text);
    }
    const hinge = this.hinge && this.item.hinges[this.hinge[point]];
    if (hinge) lines.push(`Hinge ${hinge[0]}: rest angle ${number(hinge[3])}\u00b0 \u2192 ${number(hinge[4])}\u00b0, stiffness \u00d7 ${number(hinge[5])}`);
    return lines.join('\n');
  }
}
