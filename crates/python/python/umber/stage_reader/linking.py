"""Light and shadow linking: collections of lights as categories of what they hold."""

from __future__ import annotations

from collections.abc import Iterable

from pxr import Sdf, Usd, UsdLux

from umber.description import Instancer, Light

EVERYTHING = {Sdf.Path.absoluteRootPath: Usd.Tokens.expandPrims}


class Links:
    """The links of a stage's lights. Collections with the same members are one category, as in Hydra."""

    def __init__(self, lights: Iterable[Usd.Prim]) -> None:
        self._queries: dict[str, Usd.CollectionMembershipQuery] = {}
        self._names: dict[object, str] = {}
        self._of_lights: dict[Sdf.Path, tuple[str | None, str | None]] = {}
        for prim in lights:
            api = UsdLux.LightAPI(prim)
            collections = api.GetLightLinkCollectionAPI(), api.GetShadowLinkCollectionAPI()
            light, shadow = (self._category(collection) for collection in collections)
            self._of_lights[prim.GetPath()] = light, shadow

    def _category(self, collection: Usd.CollectionAPI) -> str | None:
        """The category of what is in a collection; None where that is everything."""
        query = collection.ComputeMembershipQuery()
        rules = query.GetAsPathExpansionRuleMap()
        if rules == EVERYTHING:
            return None
        key = (frozenset(rules.items()), _expression(collection, rules))
        name = self._names.setdefault(key, collection.GetCollectionPath().pathString)
        self._queries[name] = query
        return name

    def of_path(self, path: Sdf.Path) -> list[str]:
        """Categories that a prim belongs to."""
        return [name for name, query in self._queries.items() if query.IsPathIncluded(path)]

    def link(self, prim: Usd.Prim, light: Light) -> None:
        """Gives a light its links."""
        light.light_link, light.shadow_link = self._of_lights.get(prim.GetPath(), (None, None))

    def categorize(self, instancer: Instancer, paths: list[Sdf.Path]) -> None:
        """Gives instances their categories. `paths`: theirs, or the point instancer's alone; none within another."""
        if self._queries:
            instancer.categories = [self.of_path(path) for path in paths]


def _expression(collection: Usd.CollectionAPI, rules: dict[Sdf.Path, str]) -> str:
    """The text of a collection that is a path expression."""
    return "" if rules else str(collection.ResolveCompleteMembershipExpression())
