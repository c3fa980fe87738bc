// What the viewer page uses of three.js; everything else is left out of the bundle.
export {
  AmbientLight, AnimationMixer, Box3, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, Group,
  LoopRepeat, Matrix4, Mesh, MeshStandardMaterial, NeutralToneMapping, VSMShadowMap, MeshBasicMaterial, SphereGeometry, SRGBColorSpace, PerspectiveCamera, PlaneGeometry,
  PMREMGenerator, Raycaster, Scene, ShadowMaterial, Sphere, Vector2, Vector3, WebGLRenderer,
} from 'three';
export { OrbitControls } from 'three/addons/controls/OrbitControls.js';
export { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';
export { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
