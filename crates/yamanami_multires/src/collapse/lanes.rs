//! A few numbers side by side, so that the compiler computes them with one instruction where the processor can.

use std::ops::{Add, Mul, Sub};

/// `L` numbers that go through the same sums.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lanes<T, const L: usize>(pub(super) [T; L]);

macro_rules! each {
    ($trait:ident, $method:ident, $op:tt) => {
        impl<T: Copy + $trait<Output = T>, const L: usize> $trait for Lanes<T, L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(std::array::from_fn(|l| self.0[l] $op other.0[l]))
            }
        }
    };
}

each!(Add, add, +);
each!(Sub, sub, -);
each!(Mul, mul, *);

impl Lanes<f32, 8> {
    /// The sum of all, in a fixed order.
    #[inline(always)]
    pub(super) fn sum(self) -> f32 {
        let v = self.0;
        ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]))
    }
}
