//! The Hydra delegate: the only cxx bridge, the panic guard, and the build of cpp_shim.
