// How what Rust says reaches the user: as Tf errors and warnings.
#ifndef UMBER_CPP_SHIM_REPORT_H
#define UMBER_CPP_SHIM_REPORT_H

#include "rust/cxx.h"
#include "umber-hydra/src/bridge.rs.h"

#include "pxr/pxr.h"
#include "pxr/usd/sdf/path.h"

#include <exception>

PXR_NAMESPACE_OPEN_SCOPE

/// Posts a failed call into Rust as a Tf error that names the prim.
void HdUmberReportFailure(SdfPath const &id, char const *what);

/// Posts the warnings and errors that the renderer has collected since the last call.
void HdUmberPostReports(umber::Delegate const &delegate);

/// Carries out calls into Rust. Where one fails, the rest is left out, a Tf error names the prim,
/// and the answer is false.
template <class Calls>
bool HdUmberForward(SdfPath const &id, Calls &&calls)
{
    try {
        calls();
        return true;
    } catch (std::exception const &error) {
        // rust::Error, and what cxx throws for text that is not UTF-8
        HdUmberReportFailure(id, error.what());
        return false;
    }
}

PXR_NAMESPACE_CLOSE_SCOPE

#endif
