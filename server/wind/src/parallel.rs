//! Loops over chunks of an array, parallel above a minimum size.
//!
//! Every chunk is computed from inputs that no other chunk writes, and sums are taken chunk by chunk and added in order, so results are bit-identical
//! on any number of threads.

use rayon::prelude::*;

/// Minimum number of values in a parallel loop; shorter loops take less time than waking a second thread.
const WORTH_SHARING: usize = 32_768;

/// Whether loops over this many values are parallel.
pub(super) fn is_worth_sharing(len: usize) -> bool {
    len >= WORTH_SHARING
}

/// Calls `f(number, chunk)` for each `len` values of `data`; the last chunk may be shorter.
pub(super) fn for_each_chunk<T: Send>(data: &mut [T], len: usize, f: impl Fn(usize, &mut [T]) + Sync + Send) {
    if !is_worth_sharing(data.len()) {
        data.chunks_mut(len).enumerate().for_each(|(n, chunk)| f(n, chunk));
    } else {
        data.par_chunks_mut(len).enumerate().for_each(|(n, chunk)| f(n, chunk));
    }
}

/// Calls `f(number, chunk, other)` for each `len` values of `data` with the matching `other_len` of `other`, which has as many chunks.
pub(super) fn for_each_chunk_pair<T: Send, U: Send>(
    data: &mut [T],
    len: usize,
    other: &mut [U],
    other_len: usize,
    f: impl Fn(usize, &mut [T], &mut [U]) + Sync + Send,
) {
    if !is_worth_sharing(data.len()) {
        data.chunks_mut(len).zip(other.chunks_mut(other_len)).enumerate().for_each(|(n, (chunk, other))| f(n, chunk, other));
    } else {
        data.par_chunks_mut(len).zip(other.par_chunks_mut(other_len)).enumerate().for_each(|(n, (chunk, other))| f(n, chunk, other));
    }
}
