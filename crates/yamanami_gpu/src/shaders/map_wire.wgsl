// A deformed map with its mesh's edges.

@vertex
fn map_wire_vertex(@builtin(vertex_index) index: u32) -> Ground {
    let v = vertices[indices[index]];
    var out = place(vec3(v.x, v.y, v.z));
    out.barycentric = vec3<f32>(vec3(index % 3u) == vec3(0u, 1u, 2u));
    return out;
}

@fragment
fn map_wire_fragment(in: Ground) -> @location(0) vec4<f32> {
    let b = in.barycentric;
    let across = dpdx(b);
    let down = dpdy(b);
    let wire = wire_share(b, sqrt(across * across + down * down), frame.wire_width_px, frame.wire.a);
    return shown(in.plane, dpdx(in.at_pixel), dpdy(in.at_pixel), wire);
}
