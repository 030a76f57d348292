// The surface. Vertices are placed relative to the eye, geomorphed, lit at every pixel by interpolated normals.

struct Surface {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(perspective, centroid) from_eye: vec3<f32>,
    @location(1) @interpolate(perspective, centroid) normal: vec3<f32>,
    @location(2) @interpolate(perspective, centroid) level: f32,
    @location(3) barycentric: vec3<f32>,
    @location(4) @interpolate(perspective, centroid) colour: vec3<f32>,
    @location(5) at_pixel: vec3<f32>, // from_eye once more, for its slope over the screen
}

fn place(position: vec3<f32>, detail_m: f32, error_m: f32, bound_radius_m: f32, oct: u32, painted: u32) -> Surface {
    var from_eye = position - frame.eye.xyz;
    let weight = morph_weight(error_m, bound_radius_m, length(from_eye));
    from_eye.z -= detail_m * (1.0 - weight);
    let clip = frame.clip_from_eye * vec4(from_eye, 1.0);
    let colour = linear_from_srgb(unpack4x8unorm(painted).rgb);
    return Surface(clip, from_eye, unpack_normal(oct), f32(painted >> 24u), vec3(1.0), colour, from_eye);
}

@vertex
fn terrain_vertex(
    @location(0) position: vec3<f32>,
    @location(1) fade: vec3<f32>, // detail, error, bound radius
    @location(2) normal_and_paint: vec2<u32>,
) -> Surface {
    return place(position, fade.x, fade.y, fade.z, normal_and_paint.x, normal_and_paint.y);
}

fn albedo_of(in: Surface, local: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    if frame.colour == COLOUR_PLAIN {
        return frame.plain.rgb;
    }
    if frame.colour == COLOUR_VERTEX {
        return in.colour;
    }
    if frame.colour == COLOUR_LEVEL {
        return ramp_colour(in.level * frame.ramp_per_level);
    }
    if frame.colour == COLOUR_SLOPE {
        return ramp_colour((acos(min(abs(normal.z), 1.0)) - frame.ramp_start) * frame.ramp_scale);
    }
    if frame.colour == COLOUR_ASPECT {
        return aspect_colour(normal);
    }
    let tint = ramp_colour((local.z - frame.ramp_start) * frame.ramp_scale);
    if frame.colour == COLOUR_DRAPE {
        let at = vec3(local.xy, 1.0);
        let uv = vec2(dot(frame.drape_u.xyz, at), dot(frame.drape_v.xyz, at));
        let image = textureSample(drape_texture, drape_sampler, uv);
        let inside = all(uv >= vec2(0.0)) && all(uv <= vec2(1.0));
        return mix(tint, image.rgb, select(0.0, image.a, inside));
    }
    return tint;
}

// The triangle's normal, from how its places run over the screen.
fn flat_normal(at_pixel: vec3<f32>, front: bool) -> vec3<f32> {
    let across = cross(dpdx(at_pixel), dpdy(at_pixel));
    let towards_eye = dot(across, at_pixel) < 0.0;
    return normalize(select(-across, across, towards_eye == front));
}

fn lit(in: Surface, front: bool) -> vec3<f32> {
    var normal = normalize(in.normal);
    if frame.flat_normals != 0u {
        normal = flat_normal(in.at_pixel, front);
    }
    let local = in.from_eye + frame.eye.xyz;
    let albedo = water_colour(albedo_of(in, local, normal), local.z);
    return surface_colour(albedo, in.from_eye, normal, !front);
}

@fragment
fn terrain_fragment(in: Surface, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    return to_target(lit(in, front));
}
