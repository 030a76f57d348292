// Writes changed slots to their places: each change is a slot number and the slot's words.

// First the number of changes and the words of a slot, then the changes.
@group(0) @binding(0) var<storage, read> changes: array<u32>;
@group(0) @binding(1) var<storage, read_write> slots: array<u32>;

@compute @workgroup_size(64)
fn scatter(@builtin(global_invocation_id) id: vec3<u32>) {
    let words = changes[1];
    if id.x >= changes[0] {
        return;
    }
    let change = 2u + id.x * (words + 1u);
    let slot = changes[change];
    for (var i = 0u; i < words; i++) {
        slots[slot * words + i] = changes[change + 1u + i];
    }
}
