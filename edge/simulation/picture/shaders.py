"""What the graphics library runs, in GLSL. Row 0 of a picture is row 0 of a buffer; pixel centres are at whole numbers."""

from typing import Final

VERSION: Final = "#version 430\n"

CLIP: Final = """
uniform vec2 near_far;

// Of column and row, and the depth in metres along the view, in a picture with this first pixel and so many pixels.
vec4 clip_at(vec2 pixel, float depth, vec2 first, vec2 pixels) {
    vec2 place = ((pixel + 0.5 - first) / pixels * 2.0 - 1.0) * depth;
    float n = near_far.x, f = near_far.y;
    return vec4(place, ((f + n) * depth - 2.0 * f * n) / (f - n), depth);
}
"""

LENS: Final = (
    CLIP
    + """
uniform mat3 rotation;
uniform vec3 translation;
uniform float focal[5];      // fx, skew, cx, fy, cy
uniform float distortion[5]; // k1, k2, p1, p2, k3
uniform float field_limit;
uniform vec4 window;         // the part of the picture that is drawn: first pixel, number of pixels

vec2 to_pixel(vec3 local) {
    vec2 n = local.xy / local.z;
    float r = length(n), l2 = field_limit * field_limit, beyond = 0.0;
    if (r > field_limit) {
        beyond = (r - field_limit) / field_limit
            * (1.0 + l2 * (3.0 * distortion[0] + l2 * (5.0 * distortion[1] + l2 * 7.0 * distortion[4])));
        n *= field_limit / r;
    }
    float r2 = dot(n, n);
    float radial = 1.0 + r2 * (distortion[0] + r2 * (distortion[1] + r2 * distortion[4])) + beyond;
    vec2 d = n * radial + vec2(
        2.0 * distortion[2] * n.x * n.y + distortion[3] * (r2 + 2.0 * n.x * n.x),
        distortion[2] * (r2 + 2.0 * n.y * n.y) + 2.0 * distortion[3] * n.x * n.y);
    return vec2(focal[0] * d.x + focal[1] * d.y + focal[2], focal[3] * d.y + focal[4]);
}

vec4 to_clip(vec3 local) {
    vec2 pixel = local.z >= near_far.x ? to_pixel(local)
        // Behind: without the lens, on the same line through the camera, for the near plane to cut off.
        : vec2(focal[0] * local.x + focal[1] * local.y, focal[3] * local.y) / local.z + vec2(focal[2], focal[4]);
    return clip_at(pixel, local.z, window.xy, window.zw);
}
"""
)

# As `edge.simulation.picture.lighting` has it for what moves.
LAMPS: Final = """
uniform vec3 lamp_directions[8];
uniform vec3 lamp_colours[8];
uniform int lamps;
uniform vec3 ambient;
uniform vec3 eye;
uniform float gloss;

void lighten(vec3 n, vec3 view, out vec3 light, out vec3 shine) {
    // Floors send up less than ceilings and walls send down.
    light = ambient * (0.8 + 0.2 * n.z);
    shine = vec3(0.0);
    float sharp = exp2(round(2.0 + 7.0 * gloss));
    for (int lamp = 0; lamp < lamps; ++lamp) {
        float falls = dot(n, lamp_directions[lamp]);
        if (falls <= 0.0) continue;
        light += lamp_colours[lamp] * falls;
        if (gloss > 0.0)
            shine += lamp_colours[lamp] * gloss * (sharp + 8.0) / 160.0
                * pow(max(dot(n, normalize(view + lamp_directions[lamp])), 0.0), sharp);
    }
}
"""

# What moves has landed in the picture and was lit before (`edge.simulation.picture.lens.land`, `edge.simulation.picture.lighting`).
MOVING_VERTEX: Final = (
    VERSION
    + CLIP
    + """
layout(location = 0) in vec3 landed; // column and row of pixels, depth in metres
layout(location = 1) in vec4 outer_light; // with the lamps' highlight
layout(location = 2) in vec4 inner_light;
layout(location = 3) in vec2 uv;
uniform vec2 size;
uniform vec2 nudge; // in pixels
// Slivers along an outline may not cover a pixel's middle: outside of them light would be anything.
centroid out vec4 outer, inner;
centroid out vec2 spot;

void main() {
    outer = outer_light;
    inner = inner_light;
    spot = uv;
    gl_Position = clip_at(landed.xy + nudge, landed.z, vec2(0.0), size);
}
"""
)

MOVING_FRAGMENT: Final = (
    VERSION
    + """
centroid in vec4 outer, inner;
centroid in vec2 spot;
uniform bool textured;
uniform sampler2D picture;
uniform sampler2D room_depths; // in each of the four samples of a pixel
uniform int only;              // the sample that is drawn into a target with one a pixel; -1: all four
layout(location = 0) out vec4 seen;

void main() {
    bvec4 before = lessThan(vec4(1.0 / gl_FragCoord.w), texelFetch(room_depths, ivec2(gl_FragCoord.xy), 0));
    if (only >= 0 ? !before[only] : !any(before)) discard;
    gl_SampleMask[0] = only >= 0 ? 1 : int(before.x) | int(before.y) << 1 | int(before.z) << 2 | int(before.w) << 3;
    vec3 own = textured ? texture(picture, spot).rgb : vec3(1.0);
    vec4 light = gl_FrontFacing ? outer : inner;
    seen = vec4(own * light.rgb + light.a, 1.0);
}
"""
)

ROOM_VERTEX: Final = (
    VERSION
    + LENS
    + """
layout(location = 0) in vec3 place;
layout(location = 4) in vec3 normal;
layout(location = 5) in vec3 colour;
layout(location = 6) in vec2 uv;
out vec3 at, facing, tint;
out vec2 spot;

void main() {
    at = place;
    facing = normal;
    tint = colour;
    spot = uv;
    gl_Position = to_clip(rotation * place + translation);
}
"""
)

ROOM_FRAGMENT: Final = (
    VERSION
    + LAMPS
    + """
in vec3 at, facing, tint;
in vec2 spot;
uniform bool textured;
uniform sampler2D picture;
out vec4 seen;

void main() {
    vec3 view = normalize(eye - at);
    vec3 n = normalize(facing);
    vec3 light, shine;
    lighten(dot(n, view) < 0.0 ? -n : n, view, light, shine);
    seen = vec4((textured ? tint * texture(picture, spot).rgb : tint) * light + shine, 1.0);
}
"""
)

# Where level ground is, for shadows; what is steeper or missing is not a number.
GROUND_FRAGMENT: Final = (
    VERSION
    + """
in vec3 at, facing, tint;
in vec2 spot;
uniform float highest;
out vec4 ground;

void main() {
    float nothing = uintBitsToFloat(0x7fc00000u);
    ground = vec4(abs(normalize(facing).z) > 0.9 && at.z < highest ? at.xy : vec2(nothing), 0.0, 1.0);
}
"""
)

TRUTH_FRAGMENT: Final = (
    VERSION
    + """
in vec3 at;
in vec2 shares;
flat in float face;
uniform float shown;
layout(location = 0) out vec4 surface;
layout(location = 1) out vec4 where;

void main() {
    surface = vec4(shown, face, shares);
    where = vec4(at, 1.0 / gl_FragCoord.w);
}
"""
)

ROOM_TRUTH_VERTEX: Final = (
    VERSION
    + LENS
    + """
layout(location = 0) in vec3 place;
layout(location = 1) in vec2 weights;
layout(location = 2) in float number;
out vec3 at;
out vec2 shares;
flat out float face;

void main() {
    at = place;
    shares = weights;
    face = number;
    gl_Position = to_clip(rotation * place + translation);
}
"""
)

# Each face has three corners of its own here.
MOVING_TRUTH_VERTEX: Final = (
    VERSION
    + CLIP
    + """
layout(location = 0) in vec3 landed;
layout(location = 1) in vec3 place;
uniform vec2 size;
out vec3 at;
out vec2 shares;
flat out float face;

void main() {
    at = place;
    int corner = gl_VertexID % 3;
    shares = vec2(corner == 1, corner == 2);
    face = float(gl_VertexID / 3);
    gl_Position = clip_at(landed.xy, landed.z, vec2(0.0), size);
}
"""
)

WHOLE_VERTEX: Final = (
    VERSION
    + """
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
"""
)

DEPTHS_FRAGMENT: Final = (
    VERSION
    + """
uniform sampler2DMS depths;
uniform vec2 near_far;
out vec4 metres;
void main() {
    for (int i = 0; i < 4; ++i) {
        float z = texelFetch(depths, ivec2(gl_FragCoord.xy), i).r * 2.0 - 1.0;
        metres[i] = 2.0 * near_far.x * near_far.y / (near_far.y + near_far.x - z * (near_far.y - near_far.x));
    }
}
"""
)

GATHER_FRAGMENT: Final = (
    VERSION
    + """
uniform sampler2DMS samples;
uniform float weight;
out vec4 gathered;
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    gathered = 0.25 * weight * (texelFetch(samples, pixel, 0) + texelFetch(samples, pixel, 1)
        + texelFetch(samples, pixel, 2) + texelFetch(samples, pixel, 3));
}
"""
)

GATHER_SINGLE_FRAGMENT: Final = (
    VERSION
    + """
uniform sampler2D samples;
uniform float weight;
out vec4 gathered;
void main() { gathered = weight * texelFetch(samples, ivec2(gl_FragCoord.xy), 0); }
"""
)

AVERAGE_FRAGMENT: Final = (
    VERSION
    + """
uniform sampler2D fine;
uniform int samples; // across and down
out vec4 mean;
void main() {
    ivec2 first = ivec2(gl_FragCoord.xy) * samples;
    vec4 sum = vec4(0.0);
    for (int row = 0; row < samples; ++row)
        for (int column = 0; column < samples; ++column) sum += texelFetch(fine, first + ivec2(column, row), 0);
    mean = sum / float(samples * samples);
}
"""
)
