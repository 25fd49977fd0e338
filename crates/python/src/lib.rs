//! Python module and package umber: the usd-core front end.
