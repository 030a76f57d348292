// Only places points, to hold the projection to its twin in f64.

@group(1) @binding(0) var<storage, read> points: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> places: array<vec4<f32>>;

@compute @workgroup_size(64)
fn map_points(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&points) {
        places[id.x] = place(points[id.x].xyz).clip;
    }
}
