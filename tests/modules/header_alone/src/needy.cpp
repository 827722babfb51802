struct NotDeclaredHere {};

#include "pleat/needy/needy.h"
