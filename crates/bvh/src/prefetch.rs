//! Asking for memory before it is read.

/// Bytes that processors fetch at once.
const LINE: usize = 64;

/// Asks for all of a slice: what is done meanwhile does not wait for it.
#[inline(always)]
pub fn prefetch<T>(slice: &[T]) {
    let start = slice.as_ptr().cast::<u8>();
    let in_line = start.addr() % LINE;
    for offset in (0..in_line + size_of_val(slice)).step_by(LINE) {
        line(start.wrapping_sub(in_line).wrapping_add(offset));
    }
}

/// Asks for the four lines at an address, which need not be a good one.
#[inline(always)]
pub(crate) fn prefetch_four_lines(address: *const u8) {
    for i in 0..4 {
        line(address.wrapping_add(LINE * i));
    }
}

#[inline(always)]
fn line(address: *const u8) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch reads nothing as far as the program is concerned; every processor has it.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(address.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}
