//! See `checks/mesh.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(init: umber_fuzz::stay_on_this_thread(), |input: umber_fuzz::mesh::Input| {
    umber_fuzz::mesh::check(input);
});
