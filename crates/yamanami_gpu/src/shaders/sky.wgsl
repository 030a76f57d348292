// The background: one triangle over the whole picture, at the far end of the (reversed) depth.

struct SkyVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) ndc: vec2<f32>,
}

@vertex
fn sky_vertex(@builtin(vertex_index) index: u32) -> SkyVertex {
    let ndc = vec2(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0);
    return SkyVertex(vec4(ndc, 0.0, 1.0), ndc);
}

@fragment
fn sky_fragment(in: SkyVertex) -> @location(0) vec4<f32> {
    let ray = frame.ray_forward.xyz + frame.ray_right.xyz * in.ndc.x + frame.ray_up.xyz * in.ndc.y;
    return to_target(sky_colour(normalize(ray)));
}
