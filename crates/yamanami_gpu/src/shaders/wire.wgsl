// The surface with its edges: every triangle fetches its own corners, so that each corner can carry its barycentric
// coordinates and lines are as wide, and as smooth, as asked for.

@vertex
fn wire_vertex(@builtin(vertex_index) index: u32) -> Surface {
    let v = vertices[indices[index]];
    var out = place(vec3(v.x, v.y, v.z), v.detail_m, v.error_m, v.bound_radius_m, v.normal_oct, v.painted);
    let corner = index % 3u;
    out.barycentric = vec3<f32>(vec3(corner) == vec3(0u, 1u, 2u));
    return out;
}

@fragment
fn wire_fragment(in: Surface, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    let b = in.barycentric;
    let across = dpdx(b);
    let down = dpdy(b);
    let share = wire_share(b, sqrt(across * across + down * down), frame.wire_width_px, frame.wire.a);
    return to_target(mix(lit(in, front), frame.wire.rgb, share));
}
