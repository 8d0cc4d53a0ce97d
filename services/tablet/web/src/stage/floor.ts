import { Color, Group, Mesh, PlaneGeometry, ShaderMaterial, ShadowMaterial } from 'three';

const SIZE_M = 40;

const VERTEX = /* glsl */ `
  varying vec2 place;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    place = world.xy;
    gl_Position = projectionMatrix * viewMatrix * world;
  }
`;

/** Lines of even width on the screen at every metre, finer ones at every quarter, all fading with the distance. */
const FRAGMENT = /* glsl */ `
  varying vec2 place;
  uniform vec2 centre;
  uniform vec3 line;

  float grid(float spacing, float width) {
    vec2 cell = place / spacing;
    vec2 slope = max(fwidth(cell), 1e-5);
    vec2 distance = abs(fract(cell - 0.5) - 0.5) / slope;
    float crowded = 1.0 - smoothstep(0.25, 0.6, max(slope.x, slope.y));
    return (1.0 - smoothstep(0.5 * width, 0.5 * width + 1.0, min(distance.x, distance.y))) * crowded;
  }

  void main() {
    float reach = length(place - centre);
    float fade = 1.0 - smoothstep(1.5, 7.5, reach);
    float alpha = max(0.55 * grid(1.0, 1.2), 0.2 * grid(0.25, 0.8)) * fade;
    if (alpha < 0.004) discard;
    gl_FragColor = vec4(line, alpha);
  }
`;

/** The gym's floor: metres to count, and a place for the shadow to fall. */
export class Floor {
  readonly group = new Group();
  private readonly grid: ShaderMaterial;

  constructor() {
    const plane = new PlaneGeometry(SIZE_M, SIZE_M);
    this.grid = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      transparent: true,
      depthWrite: false,
      uniforms: { centre: { value: [0, 0] }, line: { value: new Color(0x8494ab) } },
    });
    const shadow = new Mesh(plane, new ShadowMaterial({ color: 0x1b2a44, opacity: 0.24 }));
    shadow.receiveShadow = true;
    shadow.position.z = -0.002;
    this.group.add(shadow, new Mesh(plane, this.grid));
  }

  /** The lines are clearest around this place. */
  centre(x: number, y: number): void {
    this.grid.uniforms['centre']!.value = [x, y];
  }
}
