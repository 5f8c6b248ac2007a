//! Eight numbers at once: the few operations that boxes and triangles need.
//!
//! | notation | type | meaning |
//! |---|---|---|
//! | a + b, a − b, a · b, a / b | [`Pack`] | the same operation in every lane, rounded as in `f32`; none is fused |
//! | a ≤ b | [`Pack::le`] | one bit per lane |
//!
//! The operations are written twice: as plain loops ([`Plain`], for every machine), and as AVX2 instructions by the tokens of
//! `pulp`, which are safe because a token exists only where its instructions do. All of them round alike, so both give the
//! same bits.
//!
//! Everything between [`InstructionSet::run`] and these operations must be `#[inline(always)]`. A function that is not inlined is
//! compiled without AVX2, and then calls every single instruction as a function.

use super::super::plucker::Number;
use std::array::from_fn;
use std::ops::{Add, Div, Mul, Sub};

/// Number of lanes: children of a node, and triangles of a block.
pub(crate) const N: usize = 8;

/// Operations on N lanes.
pub(crate) trait Lanes: Copy {
    type F: Copy;
    fn load(self, a: &[f32; N]) -> Self::F;
    fn store(self, a: Self::F) -> [f32; N];
    fn splat(self, a: f32) -> Self::F;
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// The smaller number; b if one of them is not a number.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The larger number; b if one of them is not a number.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// One bit per lane in which a ≤ b; 0 where one of them is not a number.
    fn le(self, a: Self::F, b: Self::F) -> u32;
}

/// N numbers, with operators.
#[derive(Clone, Copy)]
pub(crate) struct Pack<L: Lanes>(L, L::F);

impl<L: Lanes> Pack<L> {
    #[inline(always)]
    pub(crate) fn load(l: L, a: &[f32; N]) -> Self {
        Self(l, l.load(a))
    }

    #[inline(always)]
    pub(crate) fn splat(l: L, a: f32) -> Self {
        Self(l, l.splat(a))
    }

    #[inline(always)]
    pub(crate) fn store(self) -> [f32; N] {
        self.0.store(self.1)
    }

    #[inline(always)]
    pub(crate) fn min(self, b: Self) -> Self {
        Self(self.0, self.0.min(self.1, b.1))
    }

    #[inline(always)]
    pub(crate) fn max(self, b: Self) -> Self {
        Self(self.0, self.0.max(self.1, b.1))
    }

    #[inline(always)]
    pub(crate) fn le(self, b: Self) -> u32 {
        self.0.le(self.1, b.1)
    }
}

macro_rules! operator {
    ($($operator:ident: $name:ident),*) => {$(
        impl<L: Lanes> $operator for Pack<L> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, b: Self) -> Self {
                Self(self.0, self.0.$name(self.1, b.1))
            }
        }
    )*};
}
operator!(Add: add, Sub: sub, Mul: mul, Div: div);

impl<L: Lanes> Number for Pack<L> {}

/// Plain loops, which the compiler vectorises as far as it can.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

macro_rules! plain {
    ($($name:ident: $f:expr;)*) => {$(
        #[inline(always)]
        fn $name(self, a: [f32; N], b: [f32; N]) -> [f32; N] {
            from_fn(#[inline(always)] |i| $f(a[i], b[i]))
        }
    )*};
}

impl Lanes for Plain {
    type F = [f32; N];
    #[inline(always)]
    fn load(self, a: &[f32; N]) -> [f32; N] {
        *a
    }
    #[inline(always)]
    fn store(self, a: [f32; N]) -> [f32; N] {
        a
    }
    #[inline(always)]
    fn splat(self, a: f32) -> [f32; N] {
        [a; N]
    }
    plain! {
        add: |a, b| a + b;
        sub: |a, b| a - b;
        mul: |a, b| a * b;
        div: |a, b| a / b;
        min: |a, b| if a < b { a } else { b };
        max: |a, b| if a > b { a } else { b };
    }
    #[inline(always)]
    fn le(self, a: [f32; N], b: [f32; N]) -> u32 {
        let mut bits = 0;
        for i in 0..N {
            bits |= u32::from(a[i] <= b[i]) << i;
        }
        bits
    }
}

/// AVX2.
#[cfg(target_arch = "x86_64")]
mod avx {
    use super::{Lanes, N};
    use pulp::{cast, f32x8, x86::V3};

    /// a ≤ b, false if one is not a number.
    const LE: i32 = 18;

    macro_rules! instructions {
        ($($name:ident: $instruction:ident),*) => {$(
            #[inline(always)]
            fn $name(self, a: f32x8, b: f32x8) -> f32x8 {
                cast(self.avx.$instruction(cast(a), cast(b)))
            }
        )*};
    }

    impl Lanes for V3 {
        type F = f32x8;
        #[inline(always)]
        fn load(self, a: &[f32; N]) -> f32x8 {
            cast(*a)
        }
        #[inline(always)]
        fn store(self, a: f32x8) -> [f32; N] {
            cast(a)
        }
        #[inline(always)]
        fn splat(self, a: f32) -> f32x8 {
            cast(self.avx._mm256_set1_ps(a))
        }
        #[inline(always)]
        fn le(self, a: f32x8, b: f32x8) -> u32 {
            self.avx._mm256_movemask_ps(self.avx._mm256_cmp_ps::<LE>(cast(a), cast(b))) as u32
        }
        instructions!(add: _mm256_add_ps, sub: _mm256_sub_ps, mul: _mm256_mul_ps, div: _mm256_div_ps,
            min: _mm256_min_ps, max: _mm256_max_ps);
    }
}

/// Work that is compiled once for each instruction set.
pub(crate) trait Task {
    type Output;
    fn run<L: Lanes>(self, l: L) -> Self::Output;
}

/// The instruction sets for which the tree is compiled.
#[derive(Clone, Copy)]
pub(crate) enum InstructionSet {
    Plain,
    #[cfg(target_arch = "x86_64")]
    Avx2(pulp::x86::V3),
    /// The same lanes with twice as many registers.
    #[cfg(target_arch = "x86_64")]
    Avx512(pulp::x86::V4),
}

impl InstructionSet {
    /// The best one of this machine.
    pub(crate) fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(v4) = pulp::x86::V4::try_new() {
            return Self::Avx512(v4);
        }
        #[cfg(target_arch = "x86_64")]
        if let Some(v3) = pulp::x86::V3::try_new() {
            return Self::Avx2(v3);
        }
        Self::Plain
    }

    /// AVX2, or plain loops if the machine does not have it.
    pub(crate) fn avx2() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(v3) = pulp::x86::V3::try_new() {
            return Self::Avx2(v3);
        }
        Self::Plain
    }

    #[inline(always)]
    pub(crate) fn run<T: Task>(self, task: T) -> T::Output {
        match self {
            Self::Plain => task.run(Plain),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(v3) => v3.vectorize(With(task, v3)),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(v4) => v4.vectorize(With(task, *v4)),
        }
    }
}

#[cfg(target_arch = "x86_64")]
struct With<T>(T, pulp::x86::V3);

#[cfg(target_arch = "x86_64")]
impl<T: Task> pulp::NullaryFnOnce for With<T> {
    type Output = T::Output;
    #[inline(always)]
    fn call(self) -> T::Output {
        self.0.run(self.1)
    }
}
