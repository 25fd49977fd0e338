//! See `checks/instances.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(init: umber_fuzz::stay_on_this_thread(), |input: umber_fuzz::instances::Input| {
    umber_fuzz::instances::check(input);
});
