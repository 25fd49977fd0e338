#include "material.h"

#include "conversions.h"
#include "report.h"

#include "pxr/base/tf/staticTokens.h"
#include "pxr/imaging/hd/sceneDelegate.h"
#include "pxr/imaging/hd/tokens.h"

PXR_NAMESPACE_OPEN_SCOPE

TF_DEFINE_PRIVATE_TOKENS(_tokens, (fallback));

HdUmberMaterial::HdUmberMaterial(SdfPath const &id, rust::Box<umber::Material> material)
    : HdMaterial(id)
    , _material(std::move(material))
{
}

void HdUmberMaterial::Sync(HdSceneDelegate *delegate, HdRenderParam *, HdDirtyBits *dirtyBits)
{
    if (*dirtyBits == Clean) {
        return;
    }
    HdUmberForward(GetId(), [&] {
        VtValue const resource = delegate->GetMaterialResource(GetId());
        HdMaterialNetwork2 network;
        if (resource.IsHolding<HdMaterialNetworkMap>()) {
            network = HdConvertToHdMaterialNetwork2(resource.UncheckedGet<HdMaterialNetworkMap>());
        } else if (resource.IsHolding<HdMaterialNetwork2>()) {
            network = resource.UncheckedGet<HdMaterialNetwork2>();
        }
        _SyncSurface(network);
        _material->commit();
    });
    *dirtyBits = Clean;
}

void HdUmberMaterial::_SyncSurface(HdMaterialNetwork2 const &network)
{
    auto const terminal = network.terminals.find(HdMaterialTerminalTokens->surface);
    auto const surface = terminal == network.terminals.end()
                             ? network.nodes.end()
                             : network.nodes.find(terminal->second.upstreamNode);
    if (surface == network.nodes.end()) {
        _material->set_surface("");
        return;
    }
    HdMaterialNode2 const &node = surface->second;
    _material->set_surface(HdUmberText(node.nodeTypeId));
    for (auto const &[name, value] : node.parameters) {
        HdUmberNumbers const numbers = HdUmberReadNumbers(value);
        if (numbers.components > 0) {
            _material->set_numbers(HdUmberText(name), numbers.Slice());
        } else {
            _material->set_text(HdUmberText(name), HdUmberReadText(value));
        }
    }
    for (auto const &[name, connections] : node.inputConnections) {
        if (connections.empty()) {
            continue;
        }
        HdMaterialConnection2 const &connection = connections.front();
        auto const upstream = network.nodes.find(connection.upstreamNode);
        if (upstream == network.nodes.end()) {
            continue;
        }
        auto const &parameters = upstream->second.parameters;
        auto const fallback = parameters.find(_tokens->fallback);
        HdUmberNumbers const numbers =
            HdUmberReadNumbers(fallback == parameters.end() ? VtValue() : fallback->second);
        _material->set_connection(HdUmberText(name), HdUmberText(upstream->second.nodeTypeId),
                                  HdUmberText(connection.upstreamOutputName), numbers.Slice());
    }
}

void HdUmberMaterial::Finalize(HdRenderParam *param)
{
    HdUmberForward(GetId(), [&] { _material->remove(); });
    HdMaterial::Finalize(param);
}

PXR_NAMESPACE_CLOSE_SCOPE
