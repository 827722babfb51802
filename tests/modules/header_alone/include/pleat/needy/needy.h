#pragma once

struct Needy {
  NotDeclaredHere member;
};
