// The mesh's buffers, for vertex shaders that fetch their own corners.

struct StoredVertex {
    x: f32,
    y: f32,
    z: f32,
    detail_m: f32,
    error_m: f32,
    bound_radius_m: f32,
    normal_oct: u32,
    painted: u32,
}

@group(1) @binding(0) var<storage, read> vertices: array<StoredVertex>;
@group(1) @binding(1) var<storage, read> indices: array<u32>;
