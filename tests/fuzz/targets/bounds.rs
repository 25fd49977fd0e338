//! See `checks/bounds.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(init: umber_fuzz::stay_on_this_thread(), |input: umber_fuzz::bounds::Input| {
    umber_fuzz::bounds::check(input);
});
