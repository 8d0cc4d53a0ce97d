import { CircleGeometry, Color, Group, Mesh, ShaderMaterial, ShadowMaterial, Vector2, Vector3 } from 'three';

/** The lines have faded away at this distance from the pupil. */
const REACH_M = 6.5;
/** The shadow of an upright pupil, and of one who lies, ends within it; a larger plane would cost more on every pixel. */
const SHADOW_REACH_M = 2.2;

const VERTEX = /* glsl */ `
  varying vec2 place;
  void main() {
    vec4 world = modelMatrix * vec4(position, 1.0);
    place = world.xy;
    gl_Position = projectionMatrix * viewMatrix * world;
  }
`;

/**
 * Lines of even width on the screen at every metre, finer ones at every quarter, all fading with the distance; and under the
 * feet the darkening where little light comes, which shows whether a foot is on the floor.
 */
const FRAGMENT = /* glsl */ `
  varying vec2 place;
  uniform vec2 centre;
  uniform vec3 line;
  uniform vec3 shade;
  uniform float reach;
  uniform vec3 contacts[3];

  float grid(float spacing, float width) {
    vec2 cell = place / spacing;
    vec2 slope = max(fwidth(cell), 1e-5);
    vec2 distance = abs(fract(cell - 0.5) - 0.5) / slope;
    float crowded = 1.0 - smoothstep(0.25, 0.6, max(slope.x, slope.y));
    return (1.0 - smoothstep(0.5 * width, 0.5 * width + 1.0, min(distance.x, distance.y))) * crowded;
  }

  float darkness(vec3 contact) {
    float size = 0.11 + 0.5 * contact.z;
    vec2 from = (place - contact.xy) / size;
    return exp(-dot(from, from)) / (1.0 + 14.0 * contact.z * contact.z + 4.0 * contact.z);
  }

  void main() {
    float fade = 1.0 - smoothstep(0.2 * reach, reach, length(place - centre));
    float lines = max(0.5 * grid(1.0, 1.2), 0.15 * grid(0.25, 0.8)) * fade;
    float dark = 1.0 - (1.0 - 0.34 * darkness(contacts[0])) * (1.0 - 0.34 * darkness(contacts[1])) * (1.0 - 0.5 * darkness(contacts[2]));
    float alpha = 1.0 - (1.0 - lines) * (1.0 - dark);
    if (alpha < 0.004) discard;
    gl_FragColor = vec4(mix(line, shade, dark / max(alpha, 1e-4)), alpha);
  }
`;

/** The gym's floor: metres to count, and a place for the shadow to fall. */
export class Floor {
  readonly group = new Group();
  private readonly contacts = [new Vector3(), new Vector3(), new Vector3()] as const;
  private readonly centre = new Vector2();

  constructor() {
    const grid = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      transparent: true,
      depthWrite: false,
      uniforms: {
        centre: { value: this.centre },
        line: { value: new Color(0x8494ab) },
        shade: { value: new Color(0x1b2a44) },
        reach: { value: REACH_M },
        contacts: { value: this.contacts },
      },
    });
    const shadow = new Mesh(
      new CircleGeometry(SHADOW_REACH_M, 32),
      new ShadowMaterial({ color: 0x1b2a44, opacity: 0.22 }),
    );
    shadow.receiveShadow = true;
    shadow.position.z = -0.002;
    this.group.add(shadow, new Mesh(new CircleGeometry(REACH_M, 48), grid));
  }

  /**
   * Puts the floor's clearest part under the pupil; its lines stay where they are in the room.
   *
   * @param left the left ankle, metres, world
   * @param right the right ankle
   */
  place(standpoint: Vector3, hips: Vector3, left: Vector3, right: Vector3): void {
    this.group.position.set(standpoint.x, standpoint.y, 0);
    this.centre.set(standpoint.x, standpoint.y);
    [left, right, hips].forEach((part, i) => this.contacts[i]!.set(part.x, part.y, Math.max(part.z - ANKLE_M, 0)));
  }
}

const ANKLE_M = 0.08;
