#include "report.h"

#include "pxr/base/tf/diagnostic.h"

#include <string>

PXR_NAMESPACE_OPEN_SCOPE

void HdUmberReportFailure(SdfPath const &id, char const *what)
{
    if (id.IsEmpty()) {
        TF_RUNTIME_ERROR("Umber: %s", what);
    } else {
        TF_RUNTIME_ERROR("Umber: <%s>: %s", id.GetText(), what);
    }
}

void HdUmberPostReports(umber::Delegate const &delegate)
{
    HdUmberForward(SdfPath(), [&] {
        for (umber::Report const &report : delegate.take_reports()) {
            std::string const text(report.text);
            if (report.is_error) {
                TF_RUNTIME_ERROR("Umber: %s", text.c_str());
            } else {
                TF_WARN("Umber: %s", text.c_str());
            }
        }
    });
}

PXR_NAMESPACE_CLOSE_SCOPE
