// A deformed map (yamanami_core's deformed/mod.rs; gpu/map_frame.rs makes the uniform block). Lengths are taken in radii
// of the ring, so that f32 keeps its digits out to the rim. Colours have their twin in software/map/paint.rs.

struct MapFrame {
    origin: vec4<f32>, // of the mesh in the plane, metres
    to_ring: vec4<f32>, // mesh origin from the map's centre (xy) and above sea (z), metres; w: 1 / ring
    eye: vec4<f32>, // eye height; exaggeration; half the bend; 1 where the drop counts from the centre
    mix: vec4<f32>, // α, its fall, s; distance of the rim
    clip_x: vec4<f32>, // clip coordinates of a place (x, y, 1)
    clip_y: vec4<f32>,
    ground: vec4<f32>, // colours times alpha, as sRGB stores them
    background: vec4<f32>,
    wire: vec4<f32>, // colour, opacity
    veil: vec4<f32>, // colour, share
    horizon: vec4<f32>, // azimuths, distances, 1 / step, 1 / slack
    wire_width_px: f32,
    texture_count: u32,
    hidden: u32,
    encode_srgb: u32,
    antialias: vec4<u32>,
    textures: array<vec4<f32>, 16>, // 1 / reach, samples from the middle to a side
}

const HIDDEN_SEEN = 0u;
const HIDDEN_DROPPED = 1u;
const BLEND_SHARE = 0.1;
const MAX_PROBES = 8.0;
const TURN = 6.2831853;

@group(0) @binding(0) var<uniform> frame: MapFrame;
@group(0) @binding(1) var pictures: texture_2d_array<f32>;
@group(0) @binding(2) var horizon: texture_2d<f32>;

struct Ground {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(perspective, centroid) plane: vec3<f32>,
    @location(1) barycentric: vec3<f32>,
    @location(2) at_pixel: vec2<f32>, // plane once more, for its slope over the screen
}

// tan(φ/2) of a point at distance d > 0 and depth below the eye.
fn half_tangent(d: f32, r: f32, height: f32) -> f32 {
    let away = select(d, r, frame.eye.w != 0.0);
    let depth = frame.eye.x - frame.eye.y * (height - frame.eye.z * away * away);
    let slant = length(vec2(d, depth));
    return select((slant - depth) / d, d / (slant + depth), depth >= 0.0);
}

// Place in the picture, in radii of the ring, of a point relative to the centre and the sea, in the same unit.
fn image_place(out: vec2<f32>, height: f32) -> vec2<f32> {
    let r = length(out);
    if r <= 1.0 {
        return out;
    }
    let alpha = frame.mix.x * pow(1.0 / r, frame.mix.y);
    let rho = alpha * r + (1.0 - alpha) * (1.0 + frame.mix.z * half_tangent(r - 1.0, r, height));
    return out * (rho / r);
}

fn place(position: vec3<f32>) -> Ground {
    let at = (position + frame.to_ring.xyz) * frame.to_ring.w;
    let image = vec3(image_place(at.xy, at.z), 1.0);
    // nearer is greater, ½ at the rim, so that no ground within the rim is cut off
    let nearness = 1.0 - 0.5 * length(at.xy) / frame.mix.w;
    let clip = vec4(dot(frame.clip_x.xyz, image), dot(frame.clip_y.xyz, image), nearness, 1.0);
    let plane = position + frame.origin.xyz;
    return Ground(clip, plane, vec3(1.0), plane.xy);
}

@vertex
fn map_vertex(@location(0) position: vec3<f32>) -> Ground {
    return place(position);
}

fn texel(at: vec2<i32>, layer: u32) -> vec4<f32> {
    let c = textureLoad(pictures, at, layer, 0);
    return vec4(c.rgb * c.a, c.a);
}

fn picture(layer: u32, uv: vec2<f32>) -> vec4<f32> {
    let half = frame.textures[layer].y;
    let at = half + uv * half;
    let corner = min(vec2<i32>(at), vec2(i32(2.0 * half) - 1));
    let part = at - vec2<f32>(corner);
    let top = mix(texel(corner, layer), texel(corner + vec2(1, 0), layer), part.x);
    let bottom = mix(texel(corner + vec2(0, 1), layer), texel(corner + vec2(1, 1), layer), part.x);
    return mix(top, bottom, part.y);
}

fn pictured(plane: vec2<f32>) -> vec4<f32> {
    var colour = vec4(0.0);
    for (var i = 0u; i < frame.texture_count; i++) {
        let uv = vec2(plane.x, -plane.y) * frame.textures[i].x;
        let room = 1.0 - max(abs(uv.x), abs(uv.y));
        if room >= 0.0 {
            let t = min(room / BLEND_SHARE, 1.0);
            let share = select(t * t * (3.0 - 2.0 * t), 1.0, i + 1u == frame.texture_count);
            colour += picture(i, uv) * (share * (1.0 - colour.a));
            if colour.a > 0.999 {
                break;
            }
        }
    }
    return colour;
}

// The mean over a pixel's footprint, along its longer side.
fn mean_pictured(at: vec2<f32>, right: vec2<f32>, down: vec2<f32>) -> vec4<f32> {
    let reach = max(abs(at.x), abs(at.y));
    for (var i = 0u; i < frame.texture_count; i++) {
        let level = frame.textures[i];
        if reach * level.x <= 1.0 {
            let spacing = 1.0 / (level.x * level.y);
            let longer = select(down, right, dot(right, right) > dot(down, down));
            let size = length(longer);
            let probes = clamp(round(size / spacing), 1.0, MAX_PROBES);
            let along = longer * min(1.0, probes * spacing / max(size, 1e-9));
            var sum = vec4(0.0);
            for (var k = 0.0; k < probes; k += 1.0) {
                sum += pictured(at + along * ((k + 0.5) / probes - 0.5));
            }
            return sum / probes;
        }
    }
    return vec4(0.0);
}

fn horizon_at(out: vec2<f32>, r: f32) -> f32 {
    let row = fract(atan2(out.x, out.y) / TURN) * frame.horizon.x;
    let column = clamp(r * frame.horizon.z, 0.0, frame.horizon.y - 1.0);
    let rows = i32(frame.horizon.x);
    let first = min(i32(row), rows - 1);
    let second = (first + 1) % rows;
    let last = i32(frame.horizon.y) - 1;
    let left = min(i32(column), max(last - 1, 0));
    let right = min(left + 1, last);
    let across = column - f32(left);
    let upper = mix(textureLoad(horizon, vec2(left, first), 0).r, textureLoad(horizon, vec2(right, first), 0).r, across);
    let lower = mix(textureLoad(horizon, vec2(left, second), 0).r, textureLoad(horizon, vec2(right, second), 0).r, across);
    return mix(upper, lower, row - f32(first));
}

fn hidden_share(out: vec2<f32>, height: f32) -> f32 {
    let r = length(out);
    if frame.hidden == HIDDEN_SEEN || r <= 1.0 {
        return 0.0;
    }
    let below = horizon_at(out, r) - half_tangent(r - 1.0, r, height);
    return clamp(below * frame.horizon.w - 1.0, 0.0, 1.0);
}

// The colour as the target wants it, still times alpha.
fn to_target(colour: vec4<f32>) -> vec4<f32> {
    if frame.encode_srgb != 0u || colour.a <= 0.0 {
        return colour;
    }
    return vec4(linear_from_srgb(colour.rgb / colour.a) * colour.a, colour.a);
}

fn shown(plane: vec3<f32>, right: vec2<f32>, down: vec2<f32>, wire: f32) -> vec4<f32> {
    let out = (plane - frame.origin.xyz + frame.to_ring.xyz) * frame.to_ring.w;
    let beyond = length(out.xy) - frame.mix.w;
    let per_px = fwidth(beyond);
    var colour: vec4<f32>;
    if frame.antialias.x != 0u {
        colour = mean_pictured(plane.xy, right, down);
    } else {
        colour = pictured(plane.xy);
    }
    colour += frame.ground * (1.0 - colour.a);
    colour = mix(colour, vec4(frame.wire.rgb, 1.0), wire);
    let hidden = hidden_share(out.xy, out.z);
    if frame.hidden == HIDDEN_DROPPED {
        colour *= 1.0 - hidden;
    } else {
        colour = vec4(mix(colour.rgb, frame.veil.rgb * colour.a, hidden * frame.veil.a), colour.a);
    }
    let soft = clamp(0.5 - beyond / max(per_px, 1e-12), 0.0, 1.0);
    colour *= select(select(0.0, 1.0, beyond <= 0.0), soft, frame.antialias.x != 0u);
    return to_target(colour + frame.background * (1.0 - colour.a));
}

@fragment
fn map_fragment(in: Ground) -> @location(0) vec4<f32> {
    return shown(in.plane, dpdx(in.at_pixel), dpdy(in.at_pixel), 0.0);
}
