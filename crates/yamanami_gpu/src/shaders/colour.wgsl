// What terrain and maps share: sRGB (palette.rs) and the lines of a wireframe (shade.rs).

fn linear_from_srgb(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, c <= vec3(0.04045));
}

fn srgb_from_linear(c: vec3<f32>) -> vec3<f32> {
    return select(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, c * 12.92, c <= vec3(0.0031308));
}

// Share of a line's colour at barycentric coordinates, whose lengths of gradient are given per pixel.
fn wire_share(b: vec3<f32>, slope_per_px: vec3<f32>, width_px: f32, opacity: f32) -> f32 {
    let slope = max(slope_per_px, vec3(1e-9));
    let distances_px = b / slope;
    let heights_px = 1.0 / slope;
    let distance_px = min(distances_px.x, min(distances_px.y, distances_px.z));
    let height_px = min(heights_px.x, min(heights_px.y, heights_px.z));
    let line = clamp(0.5 + 0.5 * width_px - distance_px, 0.0, 1.0);
    let room = clamp((height_px - 1.5) / 4.5, 0.0, 1.0);
    return opacity * line * room;
}
