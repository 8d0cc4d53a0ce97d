// Plays an exported file as three.js understands it: `node play.mjs FILE FRAMES RATE` prints, for each frame, where every named
// node or bone is in the file's own world, and how large it is: { name: [x, y, z, scale] }.
import { readFileSync } from 'node:fs';
import { AnimationMixer, LoopOnce, Vector3 } from 'three';
import { BVHLoader } from 'three/addons/loaders/BVHLoader.js';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

globalThis.self ??= globalThis;

async function opened(name, data) {
  if (name.endsWith('.bvh')) {
    const { clip, skeleton } = new BVHLoader().parse(data.toString());
    return { root: skeleton.bones[0], clip };
  }
  const bytes = data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength);
  const { scene, animations } = await new GLTFLoader().parseAsync(bytes, '');
  return { root: scene, clip: animations[0] };
}

const [file, frames, rate] = process.argv.slice(2);
const { root, clip } = await opened(file, readFileSync(file));
const mixer = new AnimationMixer(root);
const action = mixer.clipAction(clip);
action.setLoop(LoopOnce, 1);
action.clampWhenFinished = true;
action.play();
const found = [];
for (let frame = 0; frame < Number(frames); frame += 1) {
  // A little later: the file's instants are rounded, some of them up.
  mixer.setTime(Math.min(frame / Number(rate) + 1e-5, clip.duration));
  root.updateMatrixWorld(true);
  const places = {};
  root.traverse((node) => {
    if (node.name && node.name !== 'ENDSITE') {
      places[node.name] = [
        ...node.getWorldPosition(new Vector3()).toArray(),
        Math.cbrt(node.matrixWorld.determinant()),
      ];
    }
  });
  found.push(places);
}
console.log(JSON.stringify(found));
