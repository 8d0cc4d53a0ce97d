import { DirectionalLight, HemisphereLight } from 'three';

/** The shadow's picture covers a pupil who lies down. */
const SHADOW_REACH_M = 2.4;

/** The one light that throws a shadow. */
export function keyLight(): DirectionalLight {
  const light = new DirectionalLight(0xffffff, 2.0);
  light.castShadow = true;
  light.shadow.mapSize.set(1024, 1024);
  light.shadow.radius = 5;
  light.shadow.bias = -0.0006;
  light.shadow.normalBias = 0.012;
  Object.assign(light.shadow.camera, {
    left: -SHADOW_REACH_M,
    right: SHADOW_REACH_M,
    top: SHADOW_REACH_M,
    bottom: -SHADOW_REACH_M,
    near: 0.5,
    far: 12,
  });
  return light;
}

/** Light from everywhere, a little less from below. */
export function skyLight(): HemisphereLight {
  const light = new HemisphereLight(0xffffff, 0xaab6c8, 1.85);
  light.position.set(0, 0, 1);
  return light;
}
