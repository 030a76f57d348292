// What all passes share: the uniform block (frame.rs), geomorphing (morph.rs), normals (vertex.rs), light and colours
// (shade.rs). Each function has a twin of the same name there; a test compares the pictures.

struct Frame {
    clip_from_eye: mat4x4<f32>,
    eye: vec4<f32>, // w: pixels per radian
    ray_forward: vec4<f32>,
    ray_right: vec4<f32>,
    ray_up: vec4<f32>,
    lights: array<vec4<f32>, 3>,
    ramp_start: f32,
    ramp_scale: f32,
    strength: f32,
    tau_px: f32,
    morph_width: f32,
    haze_per_m: f32,
    ramp_per_level: f32,
    wire_width_px: f32,
    wire: vec4<f32>,
    plain: vec4<f32>,
    zenith: vec4<f32>,
    horizon: vec4<f32>,
    ground: vec4<f32>,
    drape_u: vec4<f32>,
    drape_v: vec4<f32>,
    water: vec4<f32>,
    ramp: array<vec4<f32>, 8>,
    colour: u32,
    encode_srgb: u32,
    size_px: vec2<f32>,
    two_sided: u32,
    flat_normals: u32,
    rest: vec2<u32>,
}

const COLOUR_PLAIN = 0u;
const COLOUR_HEIGHT = 1u;
const COLOUR_LEVEL = 2u;
const COLOUR_DRAPE = 3u;
const COLOUR_VERTEX = 4u;
const COLOUR_SLOPE = 5u;
const COLOUR_ASPECT = 6u;

const SUN_LIGHT = vec3<f32>(0.74, 0.70, 0.62);
const SKY_LIGHT = vec3<f32>(0.20, 0.24, 0.31);
const UNDERSIDE = 0.35;
const ASPECT_STRENGTH = 6.0;
const SHALLOW_WATER = vec3<f32>(0.22, 0.52, 0.75);
const DEEP_WATER = vec3<f32>(0.008, 0.05, 0.19);
const LEAST_DISTANCE_M = 1e-3;

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var drape_texture: texture_2d<f32>;
@group(0) @binding(2) var drape_sampler: sampler;

// Share of its detail that a vertex shows.
fn morph_weight(error_m: f32, bound_radius_m: f32, distance_m: f32) -> f32 {
    if frame.morph_width <= 0.0 {
        return 1.0;
    }
    let error_px = error_m * frame.eye.w / max(distance_m - bound_radius_m, LEAST_DISTANCE_M);
    return clamp((error_px / frame.tau_px - 1.0) / frame.morph_width, 0.0, 1.0);
}

fn unpack_normal(oct: u32) -> vec3<f32> {
    let e = unpack2x16snorm(oct);
    let z = 1.0 - abs(e.x) - abs(e.y);
    let fold = (vec2(1.0) - abs(e.yx)) * select(vec2(-1.0), vec2(1.0), e >= vec2(0.0));
    return normalize(vec3(select(fold, e, z >= 0.0), z));
}

fn ramp_colour(t: f32) -> vec3<f32> {
    var colour = frame.ramp[0].rgb;
    for (var i = 1u; i < 8u; i++) {
        let start = frame.ramp[i - 1u].w;
        colour = mix(colour, frame.ramp[i].rgb, clamp((t - start) / (frame.ramp[i].w - start), 0.0, 1.0));
    }
    return colour;
}

fn aspect_colour(normal: vec3<f32>) -> vec3<f32> {
    let steepness = length(normal.xy);
    let towards = select(vec2(0.0), normal.xy / steepness, steepness > 1e-6);
    let share = min(steepness * ASPECT_STRENGTH, 1.0);
    let lightness = 0.72 + share * 0.13 * 0.70710678 * (towards.y - towards.x);
    return oklab_to_linear(lightness, share * 0.125 * towards.y, share * 0.125 * towards.x);
}

fn oklab_to_linear(lightness: f32, a: f32, b: f32) -> vec3<f32> {
    let root = vec3(
        lightness + 0.39633778 * a + 0.21580376 * b,
        lightness - 0.105561346 * a - 0.06385417 * b,
        lightness - 0.08948418 * a - 1.2914855 * b,
    );
    let lms = root * root * root;
    let linear = vec3(
        dot(lms, vec3(4.0767417, -3.3077116, 0.23096994)),
        dot(lms, vec3(-1.268438, 2.6097574, -0.3413194)),
        dot(lms, vec3(-0.0041960863, -0.7034186, 1.7076147)),
    );
    return clamp(linear, vec3(0.0), vec3(1.0));
}

fn water_colour(albedo: vec3<f32>, height: f32) -> vec3<f32> {
    let depth = frame.water.x - height;
    if frame.water.z == 0.0 || depth <= 0.0 {
        return albedo;
    }
    let clear = exp(-depth * frame.water.y);
    return mix(albedo, mix(DEEP_WATER, SHALLOW_WATER, clear), 0.96 - 0.36 * clear);
}

fn light_on(normal: vec3<f32>) -> vec3<f32> {
    var lit = 0.0;
    for (var i = 0u; i < 3u; i++) {
        let light = frame.lights[i];
        lit += light.w * max(dot(normal, light.xyz), 0.0);
    }
    let sun = 1.0 + frame.strength * (lit - 1.0);
    let sky = 1.0 + frame.strength * (0.5 * normal.z - 0.5);
    return SUN_LIGHT * max(sun, 0.0) + SKY_LIGHT * sky;
}

fn sky_colour(direction: vec3<f32>) -> vec3<f32> {
    if direction.z >= 0.0 {
        return mix(frame.horizon.rgb, frame.zenith.rgb, 1.0 - exp(-4.0 * direction.z));
    }
    return mix(frame.horizon.rgb, frame.ground.rgb, 1.0 - exp(5.0 * direction.z));
}

fn surface_colour(albedo: vec3<f32>, from_eye: vec3<f32>, normal: vec3<f32>, underside: bool) -> vec3<f32> {
    let turned = underside && frame.two_sided != 0u;
    // colours that measure the ground are not to be darkened by it
    let is_measure = frame.colour == COLOUR_SLOPE || frame.colour == COLOUR_ASPECT;
    let lit = select(light_on(select(normal, -normal, turned)), SUN_LIGHT + SKY_LIGHT, is_measure);
    let light = lit * select(1.0, UNDERSIDE, underside);
    let haze = length(from_eye) * frame.haze_per_m;
    return mix(albedo * light, frame.horizon.rgb, 1.0 - exp(-haze * haze));
}

// The colour as the target wants it: linear where it encodes sRGB itself.
fn to_target(linear: vec3<f32>) -> vec4<f32> {
    if frame.encode_srgb == 0u {
        return vec4(linear, 1.0);
    }
    return vec4(srgb_from_linear(clamp(linear, vec3(0.0), vec3(1.0))), 1.0);
}
