// Everything of Asio and Beast that is no template, compiled here alone (transport/CMakeLists.txt).
#include <utility>  // before Asio: Boost 1.74 forgets it

#include <boost/asio/impl/src.hpp>
#include <boost/asio/ssl/impl/src.hpp>
#include <boost/beast/src.hpp>
