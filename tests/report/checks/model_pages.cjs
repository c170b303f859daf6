// Pages that show a glTF model by three.js and its own loader. Packages are found from the current folder.
const { readFileSync, writeFileSync } = require('fs');
const { createRequire } = require('module');

/// Writes a page that calls the program with `gltf`, `canvas` and the module `three`. Returns its file.
function modelPage(model, html, program) {
  const { buildSync } = createRequire(process.cwd() + '/')('esbuild');
  const contents = `
    import * as three from 'three';
    import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
    const canvas = document.getElementById('canvas');
    const bytes = Uint8Array.from(atob(document.getElementById('model').textContent), (c) => c.charCodeAt(0));
    new GLTFLoader().parse(bytes.buffer, '', (gltf) => {
      ${program}
      document.documentElement.dataset.ready = '';
    }, (error) => { throw error; });
  `;
  const { outputFiles } = buildSync({ stdin: { contents, resolveDir: process.cwd() }, bundle: true, write: false, format: 'iife' });
  const data = readFileSync(model).toString('base64');
  writeFileSync(html, `<!DOCTYPE html><title>Model</title><link rel="icon" href="data:,"><canvas id="canvas"></canvas>
    <script type="text/plain" id="model">${data}</script><script>${outputFiles[0].text.replace(/<\/script/g, '<\\/script')}</script>`);
  return html;
}

/// Plays the animation of a model.
const animationPage = (model, html) =>
  modelPage(model, html, `
      const renderer = new three.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
      renderer.setSize(640, 480);
      const scene = new three.Scene();
      scene.background = new three.Color(0xffffff);
      scene.add(gltf.scene, new three.HemisphereLight(0xffffff, 0x888888, 3));
      const camera = new three.PerspectiveCamera(40, 640 / 480, 0.01, 100);
      camera.position.set(6, -9, 3), camera.up.set(0, 0, 1), camera.lookAt(0, 0, -1.5);
      const mixer = new three.AnimationMixer(gltf.scene);
      mixer.clipAction(gltf.animations[0]).play().clampWhenFinished = true;
      const meshes = [];
      gltf.scene.traverse((o) => o.isMesh && meshes.push(o));
      window.animation = {
        show(time) {
          mixer.setTime(Math.min(time, gltf.animations[0].duration - 1e-6));
          renderer.render(scene, camera);
          const p = new three.Vector3();
          const z = meshes.map((m) => Array.from({ length: m.geometry.attributes.position.count }, (_, i) => m.getVertexPosition(i, p).z));
          const colors = meshes.map((m) => {
            const { color } = m.geometry.attributes;
            const targets = m.geometry.morphAttributes.color ?? [];
            return Array.from(color ? color.array : [], (c, i) => targets.reduce((sum, t, k) => sum + m.morphTargetInfluences[k] * t.array[i], c));
          });
          return { sizes: z.map((a) => a.length), z, colors };
        },
      };
  `);

/// Draws a model in the place of its texture, with the normals that its normal map has there: in a target of floats, one pixel
/// for each texel.
const decodingPage = (model, html) =>
  modelPage(model, html, `
      const renderer = new three.WebGLRenderer({ canvas });
      let drawn;
      gltf.scene.traverse((o) => o.isMesh && (drawn = o));
      const { normalMap } = drawn.material;
      normalMap.minFilter = normalMap.magFilter = three.NearestFilter;
      normalMap.generateMipmaps = false;
      const size = normalMap.image.width;
      const material = new three.MeshNormalMaterial({ normalMap, side: three.DoubleSide });
      const all = (text, from, to) => {
        if (!text.includes(from)) throw new Error('no ' + from);
        return text.replaceAll(from, to);
      };
      material.onBeforeCompile = (shader) => {
        // Which side of a face the texture shows says nothing of that of the model.
        const begin = all(three.ShaderChunk.normal_fragment_begin, 'gl_FrontFacing ? 1.0 : - 1.0', '1.0');
        shader.fragmentShader = all(shader.fragmentShader, '#include <normal_fragment_begin>', begin);
        const project = '#include <project_vertex>';
        shader.vertexShader = all(shader.vertexShader, project, project + ' gl_Position = vec4(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.0, 1.0);');
      };
      const mesh = new three.Mesh(drawn.geometry, material);
      mesh.frustumCulled = false;
      const scene = new three.Scene();
      scene.add(mesh);
      const target = new three.WebGLRenderTarget(size, size, { type: three.FloatType });
      renderer.setRenderTarget(target);
      renderer.setClearColor(0, 0);
      renderer.clear();
      renderer.render(scene, new three.Camera());
      const data = new Float32Array(4 * size * size);
      renderer.readRenderTargetPixels(target, 0, 0, size, size, data);
      window.decoded = { size, data: Array.from(data) };
  `);

module.exports = { animationPage, decodingPage };
