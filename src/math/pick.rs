//! Lists of entries of a column, and the entries of a list: sixteen at a time.
//!
//! ```text
//! list      i_j = number of the j-th entry that equals x, or differs from it
//! gather    to[j] = from[i_j]
//! ```
//!
//! In a wave, the paths that go on are listed in ascending order, and most paths do. So sixteen of them usually lie within 32
//! neighbouring places, and AVX-512 permutes these 32 numbers by one instruction. It also lists sixteen entries at a time: it
//! compresses their numbers by a mask. Other machines, and other lists, take the entries one by one. Every way gives the same result.
//!
//! Measured: `series cornell` took 0.92 of the time with these lists, `env-ggx` 0.96 (`DESIGN.md`, performance).
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | i_j | numbers of the entries | `list`, `indices` |

use pulp::bytemuck::{Pod, cast_slice, cast_slice_mut};

/// `to[j] = from[indices[j]]`.
pub fn gather<X: Pod>(to: &mut [X], from: &[X], indices: &[u32]) {
    let to = &mut to[..indices.len()];
    #[cfg(target_arch = "x86_64")]
    if size_of::<X>() == 4
        && let Some(v4) = pulp::x86::V4::try_new()
    {
        return v4.vectorize(sixteen::Gather { v4, to: cast_slice_mut(to), from: cast_slice(from), indices });
    }
    gather_by_runs(to, from, indices);
}

/// Numbers that are copied at once.
const RUN: usize = 16;

/// The same on any machine. Sixteen consecutive entries are copied as a whole.
fn gather_by_runs<X: Copy>(to: &mut [X], from: &[X], indices: &[u32]) {
    let (runs, last) = indices.as_chunks::<RUN>();
    let (places, rest) = to.as_chunks_mut::<RUN>();
    for (to, run) in places.iter_mut().zip(runs) {
        if run[RUN - 1].wrapping_sub(run[0]) as usize == RUN - 1 && run.is_sorted() {
            to.copy_from_slice(&from[run[0] as usize..][..RUN]);
        } else {
            to.iter_mut().zip(run).for_each(|(to, &i)| *to = from[i as usize]);
        }
    }
    rest.iter_mut().zip(last).for_each(|(to, &i)| *to = from[i as usize]);
}

/// Keeps only the chosen entries of one column: `v[j] = v[indices[j]]`. The indices must ascend, so the order is kept.
pub fn keep<X: Pod>(v: &mut [X], indices: &[u32]) {
    #[cfg(target_arch = "x86_64")]
    if size_of::<X>() == 4
        && let Some(v4) = pulp::x86::V4::try_new()
    {
        return v4.vectorize(sixteen::Keep { v4, v: cast_slice_mut(v), indices });
    }
    for (j, &i) in indices.iter().enumerate() {
        v[j] = v[i as usize];
    }
}

/// True if this machine lists sixteen entries at a time. Several lists of one column then cost little.
pub(crate) fn lists_at_once() -> bool {
    #[cfg(target_arch = "x86_64")]
    return pulp::x86::V4::try_new().is_some();
    #[cfg(not(target_arch = "x86_64"))]
    false
}

/// Lists the entries of a column that equal `x`. Returns their number. `list` must be longer than the column by at least fifteen; the
/// places behind the listed numbers may be written too.
pub(crate) fn list_equal(list: &mut [u32], column: &[u32], x: u32) -> usize {
    list_if::<true>(list, column, x)
}

/// The same for the entries that differ from `x`.
pub(crate) fn list_other(list: &mut [u32], column: &[u32], x: u32) -> usize {
    list_if::<false>(list, column, x)
}

fn list_if<const EQUAL: bool>(list: &mut [u32], column: &[u32], x: u32) -> usize {
    #[cfg(target_arch = "x86_64")]
    if let Some(v4) = pulp::x86::V4::try_new() {
        return v4.vectorize(sixteen::List::<EQUAL> { v4, list, column, x });
    }
    let mut n = 0;
    for (i, y) in (0..).zip(column) {
        list[n] = i;
        n += usize::from((*y == x) == EQUAL);
    }
    n
}

/// The same with AVX-512.
#[cfg(target_arch = "x86_64")]
mod sixteen {
    use pulp::{NullaryFnOnce, cast, x86::V4};

    const N: usize = 16;
    type Numbers = [u32; N];

    pub(super) struct Gather<'a> {
        pub(super) v4: V4,
        pub(super) to: &'a mut [u32],
        pub(super) from: &'a [u32],
        pub(super) indices: &'a [u32],
    }

    impl NullaryFnOnce for Gather<'_> {
        type Output = ();
        #[inline(always)]
        fn call(self) {
            let Self { v4, to, from, indices } = self;
            let (lists, last) = indices.as_chunks::<N>();
            let (places, rest) = to.as_chunks_mut::<N>();
            for (to, list) in places.iter_mut().zip(lists) {
                *to = pick(v4, from, list);
            }
            rest.iter_mut().zip(last).for_each(|(to, &i)| *to = from[i as usize]);
        }
    }

    pub(super) struct Keep<'a> {
        pub(super) v4: V4,
        pub(super) v: &'a mut [u32],
        pub(super) indices: &'a [u32],
    }

    impl NullaryFnOnce for Keep<'_> {
        type Output = ();
        #[inline(always)]
        fn call(self) {
            let Self { v4, v, indices } = self;
            let (lists, last) = indices.as_chunks::<N>();
            // what is written lies before everything that is read later
            for (j, list) in lists.iter().enumerate() {
                let kept = pick(v4, v, list);
                v[N * j..][..N].copy_from_slice(&kept);
            }
            for (j, &i) in (N * lists.len()..).zip(last) {
                v[j] = v[i as usize];
            }
        }
    }

    pub(super) struct List<'a, const EQUAL: bool> {
        pub(super) v4: V4,
        pub(super) list: &'a mut [u32],
        pub(super) column: &'a [u32],
        pub(super) x: u32,
    }

    impl<const EQUAL: bool> NullaryFnOnce for List<'_, EQUAL> {
        type Output = usize;
        #[inline(always)]
        fn call(self) -> usize {
            let Self { v4, list, column, x } = self;
            let avx = v4.avx512f;
            let all = avx._mm512_set1_epi32(x as i32);
            let mut numbers = cast(std::array::from_fn::<u32, N, _>(|i| i as u32));
            let (rows, last) = column.as_chunks::<N>();
            let mut n = 0;
            for row in rows {
                let equal = avx._mm512_cmpeq_epi32_mask(cast(*row), all);
                let chosen = if EQUAL { equal } else { !equal };
                let listed: Numbers = cast(avx._mm512_maskz_compress_epi32(chosen, numbers));
                list[n..][..N].copy_from_slice(&listed);
                n += chosen.count_ones() as usize;
                numbers = avx._mm512_add_epi32(numbers, avx._mm512_set1_epi32(N as i32));
            }
            for (i, y) in (N * rows.len()..).zip(last) {
                list[n] = i as u32;
                n += usize::from((*y == x) == EQUAL);
            }
            n
        }
    }

    /// Sixteen entries.
    #[inline(always)]
    fn pick(v4: V4, from: &[u32], list: &Numbers) -> Numbers {
        let first = list[0] as usize;
        let off = v4.avx512f._mm512_sub_epi32(cast(*list), v4.avx512f._mm512_set1_epi32(list[0] as i32));
        let near = v4.avx512f._mm512_cmplt_epu32_mask(off, v4.avx512f._mm512_set1_epi32(2 * N as i32));
        if near == u16::MAX
            && let Some([a, b]) = from.get(first..first + 2 * N).map(|from| from.as_chunks::<N>().0)
        {
            return cast(v4.avx512f._mm512_permutex2var_epi32(cast(*a), off, cast(*b)));
        }
        let mut picked = [0; N];
        for (to, &i) in picked.iter_mut().zip(list) {
            *to = from[i as usize];
        }
        picked
    }
}

#[cfg(test)]
mod tests {
    use super::{gather, gather_by_runs, keep, list_equal, list_other};

    /// Columns of few and of many entries, all of them equal, some, or none.
    #[test]
    fn lists_are_those_of_a_filter() {
        for n in [0, 1, 15, 16, 17, 100, 1000] {
            for kinds in [1, 2, 3, 50] {
                let column: Vec<u32> =
                    (0..n).map(|i: u32| i.wrapping_mul(2_654_435_761) >> 7).map(|x| x % kinds).collect();
                for x in [0, 1, u32::MAX] {
                    let mut list = vec![0; n as usize + 15];
                    let equal: Vec<u32> = (0..n).filter(|&i| column[i as usize] == x).collect();
                    let found = list_equal(&mut list, &column, x);
                    assert_eq!(list[..found], equal);
                    let other: Vec<u32> = (0..n).filter(|&i| column[i as usize] != x).collect();
                    let found = list_other(&mut list, &column, x);
                    assert_eq!(list[..found], other);
                }
            }
        }
    }

    /// Lists that skip few, many, or almost all entries, up to the end of the column, and numbers of four and of eight bytes.
    #[test]
    fn entries_are_those_of_a_plain_loop() {
        for n in [0, 1, 15, 16, 31, 32, 47, 48, 1000] {
            for skip in [0, 1, 2, 3, 10] {
                let mut chosen = 7_u32;
                let list: Vec<u32> = (0..n)
                    .filter(|_| {
                        chosen = chosen.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                        chosen >> 16 & 15 >= 3 * skip || skip == 10 && chosen >> 16 & 15 == 0
                    })
                    .collect();
                let column: Vec<f32> = (0..n).map(|i| i as f32 + 0.5).collect();
                let truth: Vec<f32> = list.iter().map(|i| *i as f32 + 0.5).collect();
                let mut kept = column.clone();
                keep(&mut kept, &list);
                assert_eq!(kept[..list.len()], truth);
                // in another order too
                let turned: Vec<u32> = list.iter().rev().copied().collect();
                for (list, truth) in [(&list, truth.clone()), (&turned, truth.iter().rev().copied().collect())] {
                    let mut found = vec![0.0; n as usize];
                    gather(&mut found, &column, list);
                    assert_eq!(found[..list.len()], truth);
                    found.fill(0.0);
                    gather_by_runs(&mut found[..list.len()], &column, list);
                    assert_eq!(found[..list.len()], truth);
                    let (wide, mut found): (Vec<u64>, _) = ((0..u64::from(n)).collect(), vec![0; n as usize]);
                    gather(&mut found, &wide, list);
                    assert!(found.iter().zip(list.iter()).all(|(a, b)| *a == u64::from(*b)));
                }
            }
        }
    }
}
