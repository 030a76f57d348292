//! What is undone after decoding an attribute stream of `EXT_meshopt_compression` or `KHR_meshopt_compression`.
//!
//! Based on: Kapoulkine and others, "KHR_meshopt_compression", appendix B, Khronos Group; Meyer and others, "On
//! floating-point normal vectors", 2010 (octahedral coordinates).

use super::meshopt_decode::MeshoptFilter;

/// Undoes a filter on elements of `stride` bytes.
pub(super) fn apply(filter: MeshoptFilter, stride: usize, data: &mut [u8]) -> Result<(), &'static str> {
    let wide = match stride {
        8 => true,
        4 => false,
        _ if matches!(filter, MeshoptFilter::None | MeshoptFilter::Exponential) => false,
        _ => return Err("a filter that wants elements of 4 or 8 bytes"),
    };
    match filter {
        MeshoptFilter::None => {}
        MeshoptFilter::Exponential => {
            for value in data.chunks_exact_mut(4) {
                let bits = i32::from_le_bytes([value[0], value[1], value[2], value[3]]);
                let (exponent, mantissa) = (bits >> 24, bits << 8 >> 8);
                // exact in double precision, so rounded once at most
                let float = (f64::from(mantissa) * f64::from(exponent).exp2()) as f32;
                value.copy_from_slice(&float.to_le_bytes());
            }
        }
        MeshoptFilter::Octahedral => {
            let (size, largest) = if wide { (2, 32767.0) } else { (1, 127.0) };
            for element in data.chunks_exact_mut(stride) {
                let [x, y, one] = [0, 1, 2].map(|k| signed(element, k, size) as f32);
                let (x, y) = (x / one, y / one);
                let z = 1.0 - x.abs() - y.abs();
                let fold = z.min(0.0);
                let (x, y) = (x + (-fold).copysign(-x), y + (-fold).copysign(-y));
                let length = (x * x + y * y + z * z).sqrt();
                for (k, c) in [x, y, z].into_iter().enumerate() {
                    put(element, k, size, (c / length * largest).round() as i32);
                }
            }
        }
        MeshoptFilter::Quaternion => {
            if !wide {
                return Err("a filter that wants elements of 8 bytes");
            }
            for element in data.chunks_exact_mut(8) {
                let [x, y, z, last] = [0, 1, 2, 3].map(|k| signed(element, k, 2));
                let scale = std::f32::consts::FRAC_1_SQRT_2 / (last | 3) as f32;
                let [x, y, z] = [x, y, z].map(|c| c as f32 * scale);
                let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
                let largest = (last & 3) as usize;
                for (k, c) in [w, x, y, z].into_iter().enumerate() {
                    put(element, (largest + k) % 4, 2, (c * 32767.0).round() as i32);
                }
            }
        }
        MeshoptFilter::Colour => {
            let (size, largest) = if wide { (2, 65535.0) } else { (1, 255.0) };
            for element in data.chunks_exact_mut(stride) {
                let mask = if wide { 0xffff } else { 0xff };
                let (luma, orange, green) =
                    (signed(element, 0, size) & mask, signed(element, 1, size), signed(element, 2, size));
                let alpha = signed(element, 3, size) & mask;
                // the highest bit of alpha says how many bits there are
                let full = (1i32 << (32 - alpha.leading_zeros())) - 1;
                let opacity = alpha & (full >> 1);
                let opacity = opacity << 1 | opacity & 1;
                let scale = largest / full as f32;
                for (k, c) in
                    [luma + orange - green, luma + green, luma - orange - green, opacity].into_iter().enumerate()
                {
                    put(element, k, size, (c as f32 * scale).round().clamp(0.0, largest) as i32);
                }
            }
        }
    }
    Ok(())
}

/// A signed number of 1 or 2 bytes.
fn signed(element: &[u8], k: usize, size: usize) -> i32 {
    if size == 1 {
        i32::from(element[k] as i8)
    } else {
        i32::from(i16::from_le_bytes([element[2 * k], element[2 * k + 1]]))
    }
}

fn put(element: &mut [u8], k: usize, size: usize, value: i32) {
    element[k * size..(k + 1) * size].copy_from_slice(&value.to_le_bytes()[..size]);
}
